// Seeded maps of the four kinds of the paper's experiment, and random tasks on them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/occupancy_map.h"
#include "coppice/planning/random.h"

namespace coppice {

enum class MapKind { blank, dense, maze, room };

/// The kind of that name; nothing for an unknown name.
std::optional<MapKind> map_kind(std::string_view name);

/// Generates a map with cells of 1 m. `blank` has no obstacle; `dense` has random star-shaped polygons over
/// 28 % of the cells; `maze` is a perfect maze (one way between any two positions) of corridors at least 24 m
/// wide with walls of 4 m; `room` has rooms of at least 60 m with doors of 20 m in walls of 4 m. There are as
/// many corridors and rooms as fit, and they fill the map. Throws std::invalid_argument for fewer than 1 or
/// more than 16384 cells a side, and for a maze or rooms on too small a map.
OccupancyMap generate_map(MapKind kind, int width, int height, Random& random);

struct StartAndGoal {
  Point2 start;
  Point2 goal;
};

/// `count` random starts and goals in the largest part of the map that a disc of `radius` (metres) can reach,
/// at least `spare` metres further from obstacles than the disc needs. Starts are at least two radii and a
/// cell apart from each other, and so are goals; if so many do not fit, two radii. Each goal is at least
/// `least_share` of the part's diagonal from its start; if the fleet is too dense for that, half as far, or a
/// quarter, and so on, but never at the start. Throws std::invalid_argument, which tells for how many robots
/// there is room, if there is too little.
std::vector<StartAndGoal> random_tasks(const ClearanceField& field, int count, double radius,
                                       double least_share, Random& random, double spare = 0);

}  // namespace coppice
