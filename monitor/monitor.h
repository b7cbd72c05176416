// A monitor: takes in a fleet's messages, and shows what it has seen to whoever connects: pages, Foxglove,
// Prometheus.
//
// Where the messages come from is its owner's business: off a bus, or from a recording, whose time is then
// passed in, and which may heed what pages wish.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "messages/bus.h"
#include "live.pb.h"
#include "monitor/fleet_view.h"
#include "monitor/live_stream.h"
#include "monitor/metrics.h"
#include "monitor/web_server.h"

namespace coppice {

class Monitor {
 public:
  /// Listens from now on; throws InputError if it cannot. `source`: for people, as "domain 3".
  Monitor(const WebSettings& settings, const std::string& source, bool recorded = false);

  void take(const std::vector<Arrival>& arrivals);
  /// For the metrics: what the process needs, and samples that its bus dropped as invalid.
  void note(double processor_seconds, std::uint64_t resident_bytes, std::uint64_t rejected = 0);
  /// Whether what is heard now is said again from a recording; its run stays one that was.
  void note_replay(bool replays);

  /// Of a recording: all that was seen is forgotten, for it goes on elsewhere.
  void forget();
  /// Of a recording: where it is.
  void show(const live::Playback& playback) { live_.show(playback); }
  /// What pages have wished since the last call; nothing that they wish reaches a fleet.
  std::vector<live::FromPage> wishes();

  /// Shows what there is to see at that time, and serves for so many seconds. `present`: the wall's clock,
  /// which is `now` unless a recording is shown.
  void turn(WallTime now, WallTime present, double seconds);

  std::string url() const { return server_.url(); }
  std::uint16_t port() const { return server_.port(); }
  bool is_watched() const { return server_.web_sockets() > 0; }

 private:
  std::optional<WebReply> get(std::string_view path) const;
  WebTalk talk(Channel channel);
  bool heard_from_page(std::string_view message, bool text);

  FleetView view_;
  LiveStream live_;
  MonitorLoad load_;
  std::optional<std::uint32_t> replayed_run_;  ///< of the view
  std::vector<live::FromPage> wishes_;
  WebServer server_;
};

}  // namespace coppice
