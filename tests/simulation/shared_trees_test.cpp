// What radius a robot is planned with is the same for the service, the broker and the agents. So robots of
// each kind graft the trees that the broker publishes while they plan.
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "simulation/fleet_simulation.h"

namespace coppice {
namespace {

constexpr int robots = 6;

/// Robots of 4 m in a maze, all holonomic.
Scenario in_a_maze() {
  Random random(3);
  Scenario scenario{.map_name = "maze", .map = generate_map(MapKind::maze, 400, 400, random), .robots = {}};
  int k = 0;
  for (const auto& [start, goal] : random_tasks(ClearanceField(scenario.map), robots, 6, 0.4, random, 1)) {
    RobotTask robot = robot_on(scenario.map);
    robot.name = "r" + std::to_string(++k);
    robot.radius = 4;
    robot.start = start;
    robot.goal = goal;
    scenario.robots.push_back(robot);
  }
  return scenario;
}

void make_differential(RobotTask& robot) {
  robot.max_angular_speed = robot.max_speed / robot.radius;
  robot.max_angular_acceleration = 4 * robot.max_angular_speed;
}

/// Trees that robots grafted, by robot.
std::map<std::string, unsigned> grafted(const Scenario& scenario, ForestStart forest,
                                        const Faults& faults = {}) {
  FleetSimulation simulation(scenario, {.timeout = 6, .faults = faults, .forest = forest});
  simulation.run([](const PlannerService&, double) { return true; });
  const proto::Report report = simulation.service().report();
  std::map<std::string, unsigned> trees;
  for (const auto& robot : report.robots())
    trees[robot.name()] = static_cast<unsigned>(robot.grafted_trees());
  return trees;
}

unsigned sum(const std::map<std::string, unsigned>& trees) {
  unsigned sum = 0;
  for (const auto& [robot, count] : trees) sum += count;
  return sum;
}

/// Both with trees that cover the map before the missions come, and with trees that grow together with them.
void expect_grafts(const Scenario& scenario, const Faults& faults = {}) {
  EXPECT_GT(sum(grafted(scenario, ForestStart::together, faults)), 0u);
  EXPECT_GT(sum(grafted(scenario, ForestStart::ahead, faults)), 0u);
}

TEST(SharedTrees, HolonomicRobotsGraftThem) {
  expect_grafts(in_a_maze());
}

TEST(SharedTrees, DifferentialRobotsGraftThem) {
  Scenario scenario = in_a_maze();
  for (RobotTask& robot : scenario.robots) make_differential(robot);
  expect_grafts(scenario);
}

TEST(SharedTrees, RobotsThatFollowGraftThem) {
  for (const bool turns : {false, true}) {
    Scenario scenario = in_a_maze();
    for (RobotTask& robot : scenario.robots) {
      robot.tracking_tolerance = 0.5;
      if (turns) make_differential(robot);
    }
    expect_grafts(scenario, {.drive = {.odometry_noise = 0.01}});
  }
}

TEST(SharedTrees, RobotsWithAFootprintGraftThem) {
  Scenario scenario = in_a_maze();
  for (RobotTask& robot : scenario.robots) {
    robot.footprint = {{3.5, 1.5}, {-3, 1.5}, {-3, -1.5}, {3.5, -1.5}};
    robot.radius = radius_of_footprint(robot.footprint, "footprint");
    make_differential(robot);
  }
  expect_grafts(scenario);
}

TEST(SharedTrees, RobotsOfEachRadiusAndDriveGraftThem) {
  Scenario scenario = in_a_maze();
  for (int k = 0; k < robots; ++k) {
    RobotTask& robot = scenario.robots[static_cast<std::size_t>(k)];
    robot.radius = k < robots / 2 ? 4 : 6;
    if (k % 2 == 0) make_differential(robot);
  }
  const auto trees = grafted(scenario, ForestStart::together);
  for (const double radius : {4.0, 6.0}) {
    for (const bool turns : {false, true}) {
      unsigned of_these = 0;
      for (const RobotTask& robot : scenario.robots) {
        if (robot.radius == radius && is_differential(limits_of(robot)) == turns)
          of_these += trees.at(robot.name);
      }
      EXPECT_GT(of_these, 0u) << radius << " m, " << (turns ? "differential" : "holonomic");
    }
  }
}

}  // namespace
}  // namespace coppice
