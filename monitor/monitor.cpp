#include "monitor/monitor.h"

#include <memory>
#include <utility>

#include "monitor/foxglove/foxglove.h"
#include "monitor/server/page_feed.h"
#include "monitor/server/web_files.h"

namespace coppice {

namespace {

constexpr std::size_t most_wishes = 64;  // between two turns; further wishes of pages are ignored

}  // namespace

Monitor::Monitor(const WebSettings& settings, const std::string& source, bool recorded,
                 std::function<std::string()> draw_order_id)
    : live_(source, recorded, !settings.token.empty()),
      load_{.has_bus = !recorded},
      server_(settings, {.get = [this](std::string_view path) { return get(path); },
                         .talk = [this](Channel channel) { return talk(channel); },
                         .api = [this](const WebRequest& request) { return api_->answer(request, view_); }}) {
  if (!settings.token.empty()) api_.emplace(std::move(draw_order_id));
}

void Monitor::take(const std::vector<Arrival>& arrivals) {
  for (const Arrival& arrival : arrivals) {
    view_.on(arrival.message, arrival.at);
    if (api_) api_->on(*arrival.message);
  }
  load_.messages += arrivals.size();
}

void Monitor::note(double processor_seconds, std::uint64_t resident_bytes, std::uint64_t rejected) {
  load_.rejected = rejected;
  load_.processor_seconds = processor_seconds;
  load_.resident_bytes = resident_bytes;
}

void Monitor::note_replay(bool replays) {
  if (replays) replayed_run_ = view_.run();
  live_.show_replayed(replayed_run_ == view_.run());
}

void Monitor::forget() {
  view_ = {};
  alarms_ = {};
  live_.begin_anew();
}

std::vector<live::FromPage> Monitor::wishes() {
  return std::exchange(wishes_, {});
}

std::vector<OrderMessage> Monitor::take_orders() {
  return api_ ? api_->take_orders() : std::vector<OrderMessage>();
}

void Monitor::turn(WallTime now, WallTime present, double seconds) {
  alarms_.look(view_, now);
  live_.look(view_, now, present, alarms_);
  if (api_) api_->look(view_, now, alarms_);
  server_.serve(seconds);
}

std::optional<WebReply> Monitor::get(std::string_view path) const {
  if (path == "/healthz") return WebReply{"text/plain; charset=utf-8", "ok\n"};
  if (path == "/metrics") {
    MonitorLoad load = load_;
    load.connections = server_.web_sockets();
    load.bytes_sent = server_.bytes_sent();
    load.refused_logins = server_.refused_logins();
    return WebReply{"text/plain; version=0.0.4; charset=utf-8",
                    metrics_text(view_, load, live_.at(), alarms_)};
  }
  const std::string_view file = path == "/" ? "/index.html" : path;
  for (const WebFile& known : web_files()) {
    if (known.path == file) return WebReply{std::string(media_type(file)), std::string(known.bytes)};
  }
  return std::nullopt;
}

WebTalk Monitor::talk(Channel channel) {
  if (channel == Channel::foxglove) {
    const auto feed = std::make_shared<FoxgloveFeed>();
    return {.next = [this, feed] { return feed->next(view_, live_); },
            .heard =
                [feed](std::string_view message, bool text) {
                  feed->on(message, text);
                  return true;
                }};
  }
  const auto feed = std::make_shared<PageFeed>();
  return {.next =
              [this, feed] {
                std::vector<Outbound> out;
                for (Payload& bytes : feed->next(view_, live_)) out.push_back({std::move(bytes)});
                return out;
              },
          .heard = [this](std::string_view message, bool text) { return heard_from_page(message, text); }};
}

bool Monitor::heard_from_page(std::string_view message, bool text) {
  live::FromPage wish;
  const bool parsed = !text && wish.ParseFromArray(message.data(), static_cast<int>(message.size())) &&
                      wish.what_case() != live::FromPage::WHAT_NOT_SET;
  if (parsed && wishes_.size() < most_wishes) wishes_.push_back(std::move(wish));
  return parsed;
}

}  // namespace coppice
