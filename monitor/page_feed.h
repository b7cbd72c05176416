// What one page is to hear next: all that is known when it connects, then what changes.
//
// A page asks when it has taken in what it was told before. So nobody queues for a slow one: it gets fewer
// frames, and loses no map, no tree, no robot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "monitor/fleet_view.h"
#include "monitor/live_stream.h"

namespace coppice {

/// Bytes of what a page is told at a time; it is less, or one message more.
inline constexpr std::size_t most_bytes_at_once = 1 << 20;
/// Edges in a message.
inline constexpr std::size_t most_edges_at_once = 1 << 14;

class PageFeed {
 public:
  /// ToPage messages, in order; none: there is no news. `live` has looked at this view.
  std::vector<Bytes> next(const FleetView& view, const LiveStream& live);

 private:
  /// How much of a robot's own trees and path it has had.
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
  std::uint64_t beat_ = 0;
  bool behind_ = false;  ///< there was more than one batch holds
  std::uint64_t map_ = 0;
  std::uint64_t roster_ = 0;
  std::uint64_t frame_ = 0;
  std::uint64_t playback_ = 0;
  std::uint64_t statuses_ = 0;  ///< the beat of the last ones
  std::size_t figures_ = 0;     ///< how many points of this run
  std::size_t trees_ = 0;
  std::shared_ptr<const Message> active_trees_{};
  std::vector<Told> robots_;
};

}  // namespace coppice
