// The next messages for one page: first all that is known, then the changes.
//
// A page gets messages when it has taken in the earlier ones. So no messages queue up for a slow page: it
// gets fewer frames, and still all maps, trees and robots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "monitor/view/fleet_view.h"
#include "monitor/view/live_stream.h"

namespace coppice {

/// Bytes that a page is sent at a time. The last message may exceed them.
inline constexpr std::size_t most_bytes_at_once = 1 << 20;
/// Edges in one message.
inline constexpr std::size_t most_edges_at_once = 1 << 14;

class PageFeed {
 public:
  /// Returns ToPage messages in order; empty if there is no news. Call it after `live` has looked at this
  /// view.
  std::vector<Payload> next(const FleetView& view, const LiveStream& live);

 private:
  /// How much of a robot's root trees and path the page has received.
  struct Told {
    std::uint32_t mission = 0;
    std::size_t root_nodes = 0;
    std::uint32_t path_revision = 0;
  };
  struct Batch;
  void add_inactive_trees(const FleetView& view, Batch& batch);
  void add_active_trees(const FleetView& view, Batch& batch);
  void add_root_trees(std::size_t number, const SeenRobot& robot, Batch& batch);
  void add_path(std::size_t number, const SeenRobot& robot, Batch& batch);
  void add_statuses(const LiveStream& live, Batch& batch);
  void add_figures(const LiveStream& live, Batch& batch);

  std::optional<std::uint32_t> run_{};
  Point2 origin_ = Point2::Zero();
  std::uint64_t slow_tick_ = 0;
  bool behind_ = false;  ///< one batch did not hold everything
  std::uint64_t map_ = 0;
  std::uint64_t roster_ = 0;
  std::uint64_t frame_ = 0;
  std::uint64_t playback_ = 0;
  std::uint64_t alarms_ = 0;
  std::uint64_t beat_ = 0;
  std::uint64_t statuses_ = 0;  ///< the slow tick of the last statuses
  std::size_t figures_ = 0;     ///< number of points received in this run
  std::size_t trees_ = 0;
  std::shared_ptr<const Message> active_trees_{};
  std::vector<Told> robots_;
};

}  // namespace coppice
