// Fleets of differential robots, simulated. They drive along their heading, arrive with their yaw, and touch
// nothing.
#include <cmath>

#include <gtest/gtest.h>

#include "coppice/files/scenario_file.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/support.h"
#include "tests/tracks.h"

namespace coppice {
namespace {

struct Driven {
  proto::Report report;
  std::vector<std::string> broken;
  std::vector<TrackPoint> last;
  double sum = 0;  ///< of the arrival times
};

Driven driven(const Scenario& scenario, const SimulationSettings& settings = {}) {
  FleetSimulation simulation(scenario, settings);
  simulation.run([](const PlannerService&, double) { return true; });
  Driven result{
      .report = simulation.service().report(), .broken = broken_invariants(scenario, simulation), .last = {}};
  for (const NamedTrack& named : simulation.tracks()) result.last.push_back(named.track.points.back());
  for (const auto& robot : result.report.robots()) result.sum += robot.run_time();
  return result;
}

/// Differential robots of the ratios of a TurtleBot 4. They start and end with yaws of all directions.
Scenario turning(Scenario scenario) {
  int k = 0;
  for (RobotTask& robot : scenario.robots) {
    robot.max_angular_speed = 0.8 * robot.max_speed / robot.radius;
    robot.max_angular_acceleration = 2 * robot.max_angular_speed;
    robot.start_yaw = wrapped(1.1 * ++k);
    robot.goal_yaw = wrapped(-2.3 * k);
    robot.goal_yaw_tolerance = default_yaw_tolerance;
  }
  return scenario;
}

TEST(DifferentialRobots, AllArriveWithTheirYawAndNoneTouchesAnything) {
  for (const char* const name : {"rooms-8.json", "dead-end.json", "door-20.json"}) {
    const Scenario scenario = read_scenario(test::scenarios() / name, {});
    const Scenario turns = turning(scenario);
    const Driven result = driven(turns);
    EXPECT_EQ(result.report.outcome(), "arrived") << name;
    EXPECT_TRUE(result.broken.empty()) << name << ": " << result.broken.front();
    for (std::size_t i = 0; i < turns.robots.size(); ++i) {
      EXPECT_LE(std::abs(wrapped(result.last[i].yaw - turns.robots[i].goal_yaw)), default_yaw_tolerance)
          << name << " " << turns.robots[i].name;
    }
    EXPECT_LT(result.sum, 2.2 * driven(scenario).sum) << name;
  }
}

TEST(DifferentialRobots, TheyShareTheWayWithHolonomicRobotsUnderLossAndDelay) {
  Scenario scenario = turning(read_scenario(test::scenarios() / "rooms-20.json", {}));
  for (std::size_t i = 0; i < scenario.robots.size(); i += 2) {
    RobotTask& robot = scenario.robots[i];
    robot.max_angular_speed = robot.max_angular_acceleration = robot.goal_yaw_tolerance = 0;
  }
  const Driven result = driven(scenario, {.faults = {.bus = {.loss = 0.2, .delay = 0.1, .jitter = 0.05}}});
  EXPECT_EQ(result.report.outcome(), "arrived");
  EXPECT_TRUE(result.broken.empty()) << result.broken.front();
}

TEST(DifferentialRobots, AnAgentThatIsKilledAndRestartedKnowsItsYaw) {
  const Scenario scenario = turning(read_scenario(test::scenarios() / "rooms-8.json", {}));
  const Driven result =
      driven(scenario, {.faults = {.kills = {{"r1", 2}, {"r2", 3.5}, {"r3", 5}}, .restart_after = 1}});
  EXPECT_EQ(result.report.outcome(), "arrived");
  EXPECT_TRUE(result.broken.empty()) << result.broken.front();
}

TEST(DifferentialRobots, RobotsThatFollowBadlyArriveAndTouchNothingUnderLossAndDelay) {
  for (const char* const name : {"storehouse-10.json", "office-20.json", "office-mixed-20.json"}) {
    const Scenario scenario = read_scenario(test::scenarios() / name, {.follow = true});
    const Driven result =
        driven(scenario,
               {.faults = {.bus = {.loss = 0.2, .delay = 0.1, .jitter = 0.05}, .drive = {0.02, 0.15, 0.05}}});
    EXPECT_EQ(result.report.outcome(), "arrived") << name;
    EXPECT_TRUE(result.broken.empty()) << name << ": " << result.broken.front();
    for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
      const RobotTask& robot = scenario.robots[i];
      EXPECT_LE((result.last[i].position - robot.goal).norm(), robot.goal_tolerance) << robot.name;
      if (robot.goal_yaw_tolerance == 0) continue;
      EXPECT_LE(std::abs(wrapped(result.last[i].yaw - robot.goal_yaw)), robot.goal_yaw_tolerance)
          << robot.name;
    }
  }
}

TEST(DifferentialRobots, AKilledAgentsRobotThatFollowsStopsAndGoesOn) {
  const Scenario scenario = read_scenario(test::scenarios() / "storehouse-10.json", {.follow = true});
  const Driven result = driven(
      scenario, {.faults = {.kills = {{"r1", 4}, {"r2", 7}}, .restart_after = 2, .drive = {0.02, 0.15, 0}}});
  EXPECT_EQ(result.report.outcome(), "arrived");
  EXPECT_TRUE(result.broken.empty()) << result.broken.front();
}

TEST(DifferentialRobots, TheyKeepTheirMarginFromObstaclesAndWhereThereIsRoomFromEachOther) {
  for (const char* const name : {"storehouse-20.json", "office-10.json"}) {
    const Scenario scenario = read_scenario(test::scenarios() / name, {});
    EXPECT_DOUBLE_EQ(scenario.margin, 0.022) << name;
    const Driven result = driven(scenario);
    EXPECT_EQ(result.report.outcome(), "arrived") << name;
    EXPECT_GE(result.report.least_clearance_with_margin(), -1e-6) << name;
    EXPECT_GE(result.report.least_separation_with_margin(), -1e-6) << name;
  }
}

TEST(DifferentialRobots, TheyDriveStraightWaysWithoutWeaving) {
  Scenario scenario = read_scenario(test::scenarios() / "storehouse-10.json", {.robots = 1});
  RobotTask& robot = scenario.robots[0];
  robot.start = {1.0, 1.0};
  robot.goal = {22.0, 1.6};
  robot.start_yaw = 1;
  robot.goal_yaw_tolerance = 0;
  const Driven result = driven(scenario);
  EXPECT_EQ(result.report.outcome(), "arrived");
  EXPECT_LT(result.sum, 21.1 / 0.5 + 3) << "it turns once, speeds up and brakes";
}

}  // namespace
}  // namespace coppice
