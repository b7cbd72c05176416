// Joint plans on the cells of a map (multi-agent path finding, MAPF): in each time step a robot goes to one
// of the four neighbouring cells, or waits.
//
// LaCAM (Okumura, "LaCAM: Search-Based Algorithm for Quick Multi-Agent Pathfinding", 2023) finds the moves
// one after the other, if its bounded memory suffices. They are then made as early as the moves before them
// allow. So the plan is not optimal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/planning/occupancy_map.h"

namespace coppice {

/// Counted from 0 along x and y.
struct GridCell {
  int x = 0;
  int y = 0;
  bool operator==(const GridCell&) const = default;
};

/// By robot: its cell at each time step. It stays at the last one.
using GridPlan = std::vector<std::vector<GridCell>>;

struct GridTask {
  GridCell start{};
  GridCell goal{};
};

/// A robot enters a cell when that is empty. It enters at the same time as another robot leaves it only if
/// both go in the same direction. So discs with a radius of up to half a cell do not touch.
///
/// Nothing: there is no plan, or none was found in `most_configurations`. Throws std::invalid_argument if a
/// start or goal is blocked, or if two robots start in one cell or have one goal.
std::optional<GridPlan> plan_on_grid(const OccupancyMap& map, std::span<const GridTask> tasks,
                                     std::uint64_t seed, std::size_t most_configurations = 1'000'000);

}  // namespace coppice
