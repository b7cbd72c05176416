// A monitor: receives a fleet's messages and shows them to its clients: pages, Foxglove, Prometheus. With a
// token, it also takes orders from clients of its HTTP API.
//
// Its owner supplies the messages, from a bus or from a recording. With a recording the owner also passes in
// its time, and may follow the wishes of pages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "live.pb.h"
#include "messages/bus.h"
#include "monitor/server/api.h"
#include "monitor/server/web_server.h"
#include "monitor/view/alarms.h"
#include "monitor/view/fleet_view.h"
#include "monitor/view/live_stream.h"
#include "monitor/view/metrics.h"

namespace coppice {

class Monitor {
 public:
  /// Listens from now on. Throws InputError if it cannot. `source`: where the messages come from, as "domain
  /// 3". `draw_order_id`: needed if the settings have a token.
  Monitor(const WebSettings& settings, const std::string& source, bool recorded = false,
          std::function<std::string()> draw_order_id = {});

  void take(const std::vector<Arrival>& arrivals);
  /// For the metrics: the load of the process, and the samples that its bus dropped as invalid.
  void note(double processor_seconds, std::uint64_t resident_bytes, std::uint64_t rejected = 0);
  /// Whether another process is replaying a recording. The current run then counts as replayed until another
  /// one begins.
  void note_replay(bool replays);

  /// Forgets all that was seen, because a recording continues at another time.
  void forget();
  /// Shows the position in a recording.
  void show(const live::Playback& playback) { live_.show(playback); }
  /// Returns the wishes of pages since the last call. No wish ever reaches a fleet.
  std::vector<live::FromPage> wishes();
  /// Returns the orders of clients since the last call. They are to be published at once.
  std::vector<OrderMessage> take_orders();

  /// Shows the view as of `now`, and serves for `seconds`. `present`: the wall clock, which equals `now`
  /// except with a recording.
  void turn(WallTime now, WallTime present, double seconds);

  std::string url() const { return server_.url(); }
  std::uint16_t port() const { return server_.port(); }
  bool is_watched() const { return server_.web_sockets() > 0; }
  /// Clients wait for what becomes of their orders.
  bool owes_replies() const { return server_.owes_replies(); }

 private:
  std::optional<WebReply> get(std::string_view path) const;
  WebTalk talk(Channel channel);
  bool heard_from_page(std::string_view message, bool text);

  FleetView view_;
  AlarmBoard alarms_;
  LiveStream live_;
  std::optional<Api> api_;  ///< if there is a token
  MonitorLoad load_;
  std::optional<std::uint32_t> replayed_run_;  ///< the view's number of that run
  std::vector<live::FromPage> wishes_;
  WebServer server_;
};

}  // namespace coppice
