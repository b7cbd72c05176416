// Without the mending of the contact after a partition (tests/regression/partition_test.cpp): a robot that
// gives its reservation up waits for those alone whose ways come near its own. The sentinel names the lemma
// before bodies touch.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/simulation/simulate.h"
#include "tests/regression/corridor_with_hall.h"

namespace coppice {
namespace {

TEST(Mutation, TheSentinelFindsTheContactAfterAPartition) {
  const Scenario scenario = test::corridor_with_hall();
  SimulationSettings settings{.timeout = 600, .plan_budget = 0, .lifelong = 25};
  settings.faults.bus.partitions = {{10.02, 10.02 + 1.47}};
  const SimulatedRun run = simulate(scenario, settings);
  ASSERT_EQ(run.broken.size(), 1U) << "the lemma, and no contact";
  EXPECT_NE(run.broken.front().find("leaves the strip of its reservation"), std::string::npos)
      << run.broken.front();
  EXPECT_TRUE(run.broken.front().starts_with("L14: ")) << run.broken.front();
}

}  // namespace
}  // namespace coppice
