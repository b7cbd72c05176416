// Seeded maps of the four kinds of the paper's experiment, and random tasks on them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "planning/clearance_field.h"
#include "planning/occupancy_map.h"
#include "planning/random.h"

namespace coppice {

enum class MapKind { blank, dense, maze, room };

/// By its name; nothing for an unknown one.
std::optional<MapKind> map_kind(std::string_view name);

/// One metre a cell. `blank` has no obstacle, `dense` random star-shaped polygons over 28 % of the cells,
/// `maze` a perfect maze (one way between any two places) of corridors at least 24 wide with walls of 4,
/// `room` rooms of at least 60 with doors of 20 in walls of 4. Corridors and rooms are as many as fit, and
/// fill the map. Throws std::invalid_argument for fewer than 1 or more than 16384 cells a side.
OccupancyMap generate_map(MapKind kind, int width, int height, Random& random);

struct StartAndGoal {
  Point2 start;
  Point2 goal;
};

/// `count` starts and goals at places of the largest part of the map that a disc of `radius` reaches, each as
/// likely, at least `spare` metres further from obstacles than it needs. Starts are apart from one another by
/// two radii and a cell, goals too; where so many do not fit, by two radii. Each goal is at least
/// `least_share` of the part's diagonal from its start; where the fleet is so dense that no such goals are
/// left, half of that, or a quarter, and so on, and never at it. Throws std::invalid_argument, which says how
/// many robots there is room for, if there is no room for them.
std::vector<StartAndGoal> random_tasks(const ClearanceField& field, int count, double radius,
                                       double least_share, Random& random, double spare = 0);

}  // namespace coppice
