// A fast robot comes along a corridor to a hall in which slow robots drive, while the network is in pieces
// for a moment. Two of them overlapped by 2.85 m.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coppice/simulation/simulate.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

/// A corridor 5 m wide, with a hall of 70 x 26 m at 800 m.
Scenario corridor_with_hall() {
  OccupancyMap map = test::open_map(1190, 26);
  for (const int side : {0, 15}) {
    const int end = side == 0 ? 10 : 26;
    test::block(map, 0, side, 800, end);
    test::block(map, 870, side, 1190, end);
  }
  constexpr double acceleration = 11.715759000754009;
  constexpr double slow = 17.672250211505325;
  return {.map_name = "corridor with hall",
          .map = std::move(map),
          .seed = 9110103,
          .robots = {{"z", {10, 12.5}, {1182, 12.5}, 2, 100, acceleration, 1},
                     {"a0", {806, 4}, {864, 4}, 3, slow, acceleration, 1},
                     {"a1", {864, 22}, {806, 22}, 3, slow, acceleration, 1},
                     {"a2", {835, 4}, {835, 22}, 3, slow, acceleration, 1}}};
}

TEST(Partition, NothingTouchesHoweverShortItIs) {
  const Scenario scenario = corridor_with_hall();
  for (const double from : {9.0, 9.6, 10.02, 10.5, 11.0}) {
    for (const double seconds : {0.5, 0.9, 1.2, 1.47, 1.8}) {
      SimulationSettings settings{.timeout = 600, .plan_budget = 0, .lifelong = 25};
      settings.faults.bus.partitions = {{from, from + seconds}};
      const SimulatedRun run = simulate(scenario, settings);
      EXPECT_TRUE(run.broken.empty())
          << fmt::format("from {} s on for {} s: {}", from, seconds, run.broken.front());
    }
  }
}

}  // namespace
}  // namespace coppice
