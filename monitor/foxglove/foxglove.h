// One client's side of Foxglove's WebSocket protocol, version 1 (github.com/foxglove/ws-protocol,
// docs/spec.md): its subscriptions, and the messages that it needs next. Clients can only observe.
//
// As with PageFeed, `next` is called when the client has taken in the earlier messages. Only topics with a
// subscription are encoded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foxglove.pb.h"
#include "monitor/view/fleet_view.h"
#include "monitor/view/live_stream.h"
#include "monitor/view/outbound.h"

namespace coppice {

/// Two names of the same protocol: bridges and applications from before 2025 use the first, later ones the
/// second.
inline constexpr std::array<std::string_view, 2> foxglove_subprotocols{"foxglove.websocket.v1",
                                                                       "foxglove.sdk.v1"};

class FoxgloveFeed {
 public:
  /// Call it after `live` has looked at this view.
  std::vector<Outbound> next(const FleetView& view, const LiveStream& live);

  /// Handles a client's message. An invalid one, as a second subscription to a channel, is answered by an
  /// error and changes nothing.
  void on(std::string_view message, bool text);

  enum class Topic : std::uint8_t { map, robots, poses, transforms, paths, trees, root_trees, log, fleet };

 private:
  /// The data about a robot that the client has received.
  struct Told {
    std::uint32_t of = 0;        ///< revision of the path, number of the mission, or phase plus one
    std::size_t root_nodes = 0;  ///< of that mission
    std::uint32_t parts = 0;     ///< number of entities that hold them
  };
  struct Subscription {
    std::uint32_t id = 0;
    Topic topic = Topic::map;
    std::optional<std::uint32_t> run{};
    std::uint64_t edition = 0;  ///< of map or frame, or the slow tick
    std::size_t items = 0;      ///< number of trees, or of points of the time series
    std::vector<Told> robots{};
  };
  static std::vector<std::string> news(Subscription& subscription, const FleetView& view,
                                       const LiveStream& live);
  static std::vector<std::string> log_news(Subscription& subscription, const FleetView& view, WallTime now);
  static void add_scene_news(Subscription& subscription, const FleetView& view, const LiveStream& live,
                             ::foxglove::SceneUpdate& update);
  static void add_path(::foxglove::SceneUpdate& update, Told& told, const SeenRobot& robot,
                       const FleetView& view, WallTime now);
  static void add_root_trees(::foxglove::SceneUpdate& update, Told& told, const SeenRobot& robot,
                             const FleetView& view, WallTime now);
  void subscribe(std::uint32_t id, std::uint32_t channel);
  void complain(const std::string& what);

  bool greeted_ = false;
  std::vector<std::string> complaints_;
  std::vector<Subscription> subscriptions_;
};

}  // namespace coppice
