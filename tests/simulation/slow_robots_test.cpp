// Robots that take long to brake, among others that do not.
#include <gtest/gtest.h>

#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

RobotTask robot(const std::string& name, const Point2& start, const Point2& goal, double max_speed,
                double max_acceleration) {
  RobotTask task;
  task.name = name;
  task.start = start;
  task.goal = goal;
  task.radius = 1;
  task.max_speed = max_speed;
  task.max_acceleration = max_acceleration;
  task.goal_tolerance = 0.1;
  return task;
}

/// A slow robot may be as fast as it can stop before those that stand could be in its way.
TEST(SlowRobots, RobotsThatStandBindThemselvesWhileASlowOnePasses) {
  Scenario scenario{.map_name = "open", .map = test::open_map(120, 40), .robots = {}};
  scenario.robots.push_back(robot("slow", {5, 20}, {115, 20}, 2.5, 0.05));
  for (int k = 0; k < 4; ++k) {
    const Point2 beside(20 + 25 * k, k % 2 == 0 ? 10 : 30);
    scenario.robots.push_back(robot("quick" + std::to_string(k), beside, beside, 20, 100));
  }
  FleetSimulation simulation(scenario, {.timeout = 600});
  simulation.run([](const PlannerService&, double) { return true; });
  const proto::Report report = simulation.service().report();
  ASSERT_EQ(report.outcome(), "arrived");
  EXPECT_TRUE(broken_invariants(scenario, simulation.tracks(), control_period).empty());
  EXPECT_LT(report.robots(0).run_time(), 1.5 * report.robots(0).free_flow_time());
}

}  // namespace
}  // namespace coppice
