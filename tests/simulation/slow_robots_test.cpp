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
  EXPECT_TRUE(broken_invariants(scenario, simulation).empty());
  EXPECT_LT(report.robots(0).run_time(), 1.5 * report.robots(0).free_flow_time());
}

/// The way of the quick robot leads into the slow one, and a joint plan lets both set off at once. They stood
/// for ever: the turn of the quick one came first, by its name.
TEST(SlowRobots, AQuickRobotLetsASlowOneThatStandsInItsWayGetAway) {
  Scenario scenario{.map_name = "cells", .map = test::open_map(9, 7), .robots = {}};
  for (const auto& [x, y] : {std::pair(1, 0), {5, 0}, {6, 0}, {2, 1}, {1, 2}, {3, 3}, {0, 4}, {5, 4}, {4, 5}})
    test::block(scenario.map, x, y, x + 1, y + 1);
  const auto add = [&](const std::string& name, const Point2& start, const Point2& goal, double radius,
                       double max_acceleration) {
    RobotTask& task = scenario.robots.emplace_back(robot(name, start, goal, 0.103, max_acceleration));
    task.radius = radius;
  };
  add("a quick", {3.5592, 2.61617}, {7.5, 2.5}, 0.3154, 0.65);
  add("b slow", {4.061, 2.7845}, {5.5, 3.5}, 0.2117, 0.00103);
  scenario.robots.front().max_angular_speed = 0.55;
  scenario.robots.front().max_angular_acceleration = 2.4;
  scenario.robots.front().start_yaw = 2.1;
  SimulationSettings settings{.timeout = 3600, .plan_budget = 0};
  for (const RobotTask& task : scenario.robots) {
    const double arrives = (task.goal - task.start).norm() / task.max_speed + 0.01;
    settings.plan.push_back({{0, task.start}, {arrives, task.goal}});
  }
  FleetSimulation simulation(scenario, settings);
  simulation.run([](const PlannerService&, double) { return true; });
  const proto::Report report = simulation.service().report();
  ASSERT_EQ(report.outcome(), "arrived");
  EXPECT_TRUE(broken_invariants(scenario, simulation).empty());
  for (const auto& each : report.robots()) EXPECT_LT(each.run_time(), 300) << each.name();
}

}  // namespace
}  // namespace coppice
