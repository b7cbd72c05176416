// A fleet in Foxglove's messages (idl/foxglove.proto): one function for each topic.
//
// Foxglove's frame is right-handed with z up, seen from above: y grows up the screen. On maps whose y grows
// downwards every y changes its sign, so that what is seen is the map as its file shows it; headings turn
// with it. The frame of everything is called "map". Lines are drawn from the map's origin on: viewers hold
// their points as floats, which have seven figures.
#pragma once

#include <cstddef>
#include <cstdint>

#include "foxglove.pb.h"
#include "monitor/fleet_view.h"

namespace coppice::foxglove_scene {

inline constexpr const char* frame_id = "map";

/// Robots vanish from the scene when nobody has said for so long where they are, seconds.
inline constexpr double robot_lifetime = 2;

/// How a place on the map becomes one in Foxglove.
struct Projection {
  bool y_down = true;
  Point2 origin = Point2::Zero();  ///< of the map, where lines are drawn from
  Point2 operator()(const Point2& p) const { return {p.x(), y_down ? -p.y() : p.y()}; }
};
Projection projection_of(const FleetView& view);

/// More cells than this are shown in larger ones, blocked where any of theirs is: four bytes each go to the
/// client.
inline constexpr std::size_t most_cells = std::size_t{1} << 22;

/// Walls dark, what is free see-through.
::foxglove::Grid grid(const MapMessage& map, WallTime now);

/// Cylinders, with an arrow of the way of half a second while they move, and their names.
::foxglove::SceneUpdate robots(const FleetView& view, WallTime now);
/// In the order of the roster; a robot that was not heard of yet is left out.
::foxglove::PosesInFrame poses(const FleetView& view, WallTime now);
/// From the map to each robot.
::foxglove::FrameTransforms transforms(const FleetView& view, WallTime now);

/// A robot's path, to its goal; without a path, its deletion.
void add_path(::foxglove::SceneUpdate& scene, const SeenRobot& robot, Projection projection, WallTime now);
void add_inactive_tree(::foxglove::SceneUpdate& scene, const InactiveTreeMessage& tree, Projection projection,
                       WallTime now);
/// Of both of a robot's own trees the edges to the nodes from `first` on. They grow by such parts, each an
/// entity.
void add_root_trees(::foxglove::SceneUpdate& scene, const SeenRobot& robot, std::size_t first,
                    std::uint32_t part, Projection projection, WallTime now);
void delete_root_trees(::foxglove::SceneUpdate& scene, const RobotName& robot, std::uint32_t parts,
                       WallTime now);
/// All that was shown on this topic goes.
void add_deletion_of_all(::foxglove::SceneUpdate& scene, WallTime now);

/// What there is to say of a robot that has come to another phase.
::foxglove::Log log_of(const SeenRobot& robot, WallTime now);

}  // namespace coppice::foxglove_scene
