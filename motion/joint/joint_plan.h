// A plan for robots that are in each other's way: moves that are made one after the other, while all other
// robots stand.
//
// Such a plan is safe at any pace. Robots may move at the same time as long as they keep the plan's order
// wherever their ways come near each other (precedence.h).
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "coppice/planning/geometry.h"
#include "motion/trajectory/segments.h"

namespace coppice {

struct JointTask {
  Point2 position = Point2::Zero();
  std::optional<Point2> goal;  ///< none: any position will do
  double radius = 0;
  bool movable = true;  ///< false: a failed robot; it stays where it is and has no goal
};

/// Where the robot is to stand in the end; none: any position will do.
inline std::optional<Point2> end_of(const JointTask& task) {
  return task.movable ? task.goal : task.position;
}

/// The robots that are not movable.
inline std::vector<Disc> immovable(std::span<const JointTask> tasks) {
  std::vector<Disc> discs;
  for (const JointTask& task : tasks) {
    if (!task.movable) discs.push_back({task.position, task.radius});
  }
  return discs;
}

struct Move {
  std::size_t robot = 0;  ///< index among the robots of the plan
  Path path;
  bool operator==(const Move&) const = default;
};

struct JointPlan {
  std::vector<Move> moves;
  std::vector<std::size_t> stranded;  ///< robots that the moves do not bring to their goals
};

}  // namespace coppice
