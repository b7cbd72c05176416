// Two robots side by side crept at 0.035 m/s. The last robot arrived after 2,251 s.
#include <gtest/gtest.h>

#include "coppice/simulation/simulate.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

/// A corridor 11 m wide leads to a hall of 140 x 70 m.
Scenario corridor_to_hall() {
  OccupancyMap map = test::open_map(990, 70);
  test::block(map, 0, 0, 850, 29);
  test::block(map, 0, 40, 850, 70);
  constexpr double acceleration = 9.264366378903503;
  constexpr double slow = 22.263230969902402;
  return {.map_name = "corridor to hall",
          .map = std::move(map),
          .seed = 9109437,
          .robots = {{"z", {10, 34.5}, {982, 34.5}, 5, 92.92105584711936, acceleration, 1},
                     {"a0", {870, 8}, {870, 62}, 6, slow, acceleration, 1},
                     {"a1", {900, 62}, {910, 8}, 6, slow, acceleration, 1},
                     {"a2", {930, 8}, {925, 62}, 6, slow, acceleration, 1}}};
}

TEST(Crawl, RobotsSideBySideDoNotHoldEachOtherUp) {
  const Scenario scenario = corridor_to_hall();
  const SimulatedRun run = simulate(scenario, {.timeout = 3600, .plan_budget = 0, .lifelong = 40});
  EXPECT_TRUE(run.broken.empty()) << run.broken.front();
  EXPECT_TRUE(run.arrived);
  EXPECT_LT(run.run_time, 120);
}

}  // namespace
}  // namespace coppice
