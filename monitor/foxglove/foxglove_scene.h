// A fleet as messages of Foxglove (idl/foxglove.proto): one function for each topic.
//
// Foxglove's frame is right-handed with z up: seen from above, y grows up the screen. For maps whose y grows
// downwards, each y and each heading changes its sign, so that the view shows the map as its file does. The
// frame's name is "map". Lines are drawn relative to the map's origin, because viewers store their points as
// floats with seven digits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "foxglove.pb.h"
#include "monitor/view/fleet_view.h"

namespace coppice::foxglove_scene {

inline constexpr const char* frame_id = "map";

/// Seconds. A robot vanishes from the scene when its position has not been sent for this long.
inline constexpr double robot_lifetime = 2;

/// Converts a position on the map to Foxglove's frame.
struct Projection {
  bool y_down = true;
  Point2 origin = Point2::Zero();  ///< of the map: lines are drawn relative to it
  Point2 operator()(const Point2& p) const { return {p.x(), y_down ? -p.y() : p.y()}; }
};
Projection projection_of(const FleetView& view);

/// A map with more cells is sent in larger cells, each blocked where any of its cells is. A cell takes four
/// bytes.
inline constexpr std::size_t most_cells = std::size_t{1} << 22;

/// Walls are dark, and free cells are transparent.
::foxglove::Grid grid(const MapMessage& map, WallTime now);

/// Cylinders with the robots' names. A moving robot has an arrow that shows its motion in half a second.
::foxglove::SceneUpdate robots(const FleetView& view, WallTime now);
/// In the order of the roster, without the robots that have not been heard.
::foxglove::PosesInFrame poses(const FleetView& view, WallTime now);
/// The transforms from the map to each robot.
::foxglove::FrameTransforms transforms(const FleetView& view, WallTime now);

/// Adds a robot's path to its goal. Adds the path's deletion if there is none.
void add_path(::foxglove::SceneUpdate& scene, const SeenRobot& robot, Projection projection, WallTime now);
void add_inactive_tree(::foxglove::SceneUpdate& scene, const InactiveTreesMessage& tree,
                       Projection projection, WallTime now);
/// Adds the edges of both root trees of a robot to the nodes from `first` on. Each such part is an entity.
void add_root_trees(::foxglove::SceneUpdate& scene, const SeenRobot& robot, std::size_t first,
                    std::uint32_t part, Projection projection, WallTime now);
void delete_root_trees(::foxglove::SceneUpdate& scene, const RobotName& robot, std::uint32_t parts,
                       WallTime now);
/// Deletes everything that was shown on this topic.
void add_deletion_of_all(::foxglove::SceneUpdate& scene, WallTime now);

/// The log message of a robot that has entered another phase.
::foxglove::Log log_of(const SeenRobot& robot, WallTime now);

}  // namespace coppice::foxglove_scene
