// Without the mending of the stale progress (tests/simulation/reservation_progress_test.cpp): a robot that
// only brakes goes on to say how far it had come before. Others open their gates by that.
#include <string>

#include <gtest/gtest.h>

#include "coppice/files/scenario_generator.h"
#include "coppice/simulation/simulate.h"

namespace coppice {
namespace {

TEST(Mutation, TheSentinelFindsTheStaleProgress) {
  Scenario scenario = make_scenario("rooms", 6, 1);
  for (RobotTask& robot : scenario.robots) robot.max_acceleration = robot.max_speed / 2;
  SimulationSettings settings{.timeout = 300, .plan_budget = 0.1, .lifelong = 60};
  settings.faults = {.bus = {.loss = 0.1, .delay = 0.05, .partitions = {{14, 16}, {25, 25.8}, {43, 47}}},
                     .pause_rate = 200,
                     .pause = 0.5};
  const SimulatedRun run = simulate(scenario, settings);
  ASSERT_EQ(run.broken.size(), 1U) << "the lemma, and no contact";
  EXPECT_TRUE(run.broken.front().starts_with("L14: ")) << run.broken.front();
  EXPECT_NE(run.broken.front().find("says that it comes"), std::string::npos) << run.broken.front();
}

}  // namespace
}  // namespace coppice
