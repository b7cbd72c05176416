// Tests of joint plans on the cells of a map.
#include "coppice/motion/grid_plan.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "coppice/files/plan_file.h"
#include "coppice/planning/random.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

using test::open_map;

// The check against a scenario refuses a plan in which discs touch, or that leads elsewhere.
TEST(GridPlan, DiscsAsWideAsACellReachTheirGoalsAndDoNotTouch) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    Scenario scenario{.map_name = "m", .map = open_map(8, 8), .robots = {}};
    std::vector<int> starts;
    for (int cell = 0; cell < 64; ++cell) {
      if (random.uniform() < 0.15) {
        scenario.map.blocked[static_cast<std::size_t>(cell)] = 1;
      } else {
        starts.push_back(cell);
      }
    }
    std::vector<int> goals = starts;
    for (std::size_t k = starts.size(); k > 1; --k) {
      std::swap(starts[k - 1], starts[random.index(k)]);
      std::swap(goals[k - 1], goals[random.index(k)]);
    }
    for (std::size_t k = 0; k < 12; ++k) {
      const auto place = [](int cell) { return Point2(cell % 8 + 0.5, cell / 8 + 0.5); };
      scenario.robots.push_back({std::to_string(k), place(starts[k]), place(goals[k]), 0.5, 1, 2, 0.1});
    }
    const auto plan = plan_on_grid(scenario.map, grid_tasks_of(scenario), seed);
    if (!plan) continue;  // a robot may be shut in
    ++found;
    EXPECT_NO_THROW(trajectories_of(*plan, scenario)) << "seed " << seed;
  }
  EXPECT_GE(found, 12) << "of 20 seeds";
}

TEST(GridPlan, RobotsFollowEachOtherWithoutAGap) {
  const GridTask first{{1, 0}, {4, 0}};
  const GridTask second{{0, 0}, {3, 0}};
  const auto plan = plan_on_grid(open_map(5, 1), std::vector{first, second}, 1);
  ASSERT_TRUE(plan);
  for (const auto& cells : *plan) EXPECT_EQ(cells.size(), 4u);
}

TEST(GridPlan, TwoRobotsThatCannotPassHaveNoPlan) {
  const std::vector<GridTask> swap{{{0, 0}, {3, 0}}, {{3, 0}, {0, 0}}};
  EXPECT_FALSE(plan_on_grid(open_map(4, 1), swap, 1));
  EXPECT_TRUE(plan_on_grid(open_map(4, 2), swap, 1));
}

TEST(GridPlan, BadTasksAreRefused) {
  OccupancyMap map = open_map(3, 1);
  map.blocked[2] = 1;
  EXPECT_THROW(plan_on_grid(map, std::vector<GridTask>{{{0, 0}, {2, 0}}}, 1), std::invalid_argument);
  EXPECT_THROW(plan_on_grid(map, std::vector<GridTask>{{{0, 0}, {9, 0}}}, 1), std::invalid_argument);
  const std::vector<GridTask> same{{{0, 0}, {1, 0}}, {{1, 0}, {1, 0}}};
  EXPECT_THROW(plan_on_grid(map, same, 1), std::invalid_argument);
}

}  // namespace
}  // namespace coppice
