// The map and the tasks of a fuzz case, before anything is known of the robots' bodies.
//
// Metres in the map frame.
#pragma once

#include <cstdint>
#include <optional>

#include "coppice/files/scenario.h"
#include "coppice/motion/grid_plan.h"

namespace coppice {

struct FuzzTasks {
  /// The radius of a robot here is the room that its task leaves it; its speed is 0.
  Scenario scenario;
  /// A joint plan that was made elsewhere, for robots that are to drive by it.
  std::optional<GridPlan> plan{};
};

/// A kind of the scenarios that test coordination, a generated map with random tasks, or a puzzle on few
/// cells, in any scale.
FuzzTasks draw_tasks(std::uint32_t seed);

}  // namespace coppice
