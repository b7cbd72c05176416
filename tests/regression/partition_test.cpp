// A fast robot comes along a corridor to a hall in which slow robots drive, while the network is in pieces
// for a moment. Two of them overlapped by 2.85 m.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coppice/simulation/simulate.h"
#include "tests/regression/corridor_with_hall.h"

namespace coppice {
namespace {

TEST(Partition, NothingTouchesHoweverShortItIs) {
  const Scenario scenario = test::corridor_with_hall();
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
