// Small maps, and plans on them that are checked move by move with nothing but the clearance field and
// distances.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/clearance_field.h"
#include "motion/joint/joint_plan.h"
#include "motion/trajectory/segments.h"

namespace coppice::test {

inline OccupancyMap open_map(int width, int height) {
  OccupancyMap map{.width = width, .height = height, .blocked = {}};
  map.blocked.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  return map;
}

inline void block(OccupancyMap& map, int i0, int j0, int i1, int j1, bool blocked = true) {
  for (int j = j0; j < j1; ++j) {
    for (int i = i0; i < i1; ++i) map.blocked[static_cast<std::size_t>(j * map.width + i)] = blocked;
  }
}

/// A hall of 100 m x 100 m with an aisle 14 m wide that ends blind.
inline OccupancyMap hall_and_aisle() {
  OccupancyMap map = open_map(300, 100);
  block(map, 100, 0, 300, 100);
  block(map, 100, 43, 290, 57, false);
  return map;
}

/// The final positions. Each move must begin where its robot is, and pass all obstacles and robots.
inline std::vector<Point2> driven(const OccupancyMap& map, std::span<const JointTask> tasks,
                                  const JointPlan& plan) {
  const ClearanceField field(map);
  std::vector<Point2> at;
  for (const JointTask& task : tasks) at.push_back(task.position);
  for (const Move& move : plan.moves) {
    const double radius = tasks[move.robot].radius;
    EXPECT_TRUE(tasks[move.robot].movable);
    EXPECT_EQ(move.path.front(), at[move.robot]);
    for (std::size_t k = 1; k < move.path.size(); ++k) {
      EXPECT_TRUE(field.segment_free(move.path[k - 1], move.path[k], radius));
      for (std::size_t i = 0; i < tasks.size(); ++i) {
        if (i == move.robot) continue;
        EXPECT_GE(point_segment_distance(at[i], move.path[k - 1], move.path[k]), radius + tasks[i].radius);
      }
    }
    at[move.robot] = move.path.back();
  }
  return at;
}

}  // namespace coppice::test
