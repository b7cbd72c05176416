// A plan for a fleet that stands in its own way: moves, robots one after the other, all others standing.
//
// A plan of that form is safe whatever the pace: robots may move at the same time as long as they keep the
// plan's order wherever their ways come near each other (precedence.h).
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "planning/geometry.h"

namespace coppice {

struct JointTask {
  Point2 position = Point2::Zero();
  std::optional<Point2> goal;  ///< none: anywhere
  double radius = 0;
  bool movable = true;  ///< false: failed; it stays where it is, and has no goal
};

/// Where it is to stand in the end; none: anywhere.
inline std::optional<Point2> end_of(const JointTask& task) {
  return task.movable ? task.goal : task.position;
}
inline bool wants_to_move(const JointTask& task) {
  return task.movable && task.goal && *task.goal != task.position;
}

struct Move {
  std::size_t robot = 0;  ///< index among those that the plan is for
  Path path;
  bool operator==(const Move&) const = default;
};

struct JointPlan {
  std::vector<Move> moves;
  std::vector<std::size_t> stranded;  ///< robots that these moves do not bring to their goals
};

}  // namespace coppice
