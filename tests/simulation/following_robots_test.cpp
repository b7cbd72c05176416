// Tests of fleets whose robots follow badly: late, with wheels that slip, and seen with noise.
#include <algorithm>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "simulation/drive_limits.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"

namespace coppice {
namespace {

/// Robots in a row that change sides: each drives through between two others.
Scenario opposite_rows(const RobotTask& robot, double distance) {
  constexpr int a_side = 3;
  Scenario scenario{.map = {.width = 60, .height = 60, .blocked = std::vector<std::uint8_t>(3600)},
                    .robots = {}};
  for (int k = 0; k < 2 * a_side; ++k) {
    RobotTask task = robot;
    task.name = fmt::format("r{}", k + 1);
    const double y = 30 + distance * (k % a_side - 1);
    const bool left = k < a_side;
    task.start = {left ? 10.0 : 50.0, y};
    task.goal = {left ? 50.0 : 10.0, y};
    task.start_yaw = left ? 0 : std::numbers::pi;
    scenario.robots.push_back(task);
  }
  return scenario;
}

/// Metres that a robot was off its reference at most. `said`: where the references were.
double furthest_off(const std::vector<RobotState>& said, const NamedTrack& track) {
  double furthest = 0;
  for (const RobotState& state : said) {
    const double stamp = state.promise.stamp;
    const auto after = std::ranges::lower_bound(track.track.points, stamp, {}, &TrackPoint::time);
    if (state.robot != track.robot || after == track.track.points.begin() ||
        after == track.track.points.end())
      continue;
    const TrackPoint& before = *(after - 1);
    const Point2 was = before.position + (stamp - before.time) * before.velocity;
    furthest = std::max(furthest, (was - state.promise.position).norm());
  }
  return furthest;
}

void expect_to_keep_within_tolerances(const Scenario& scenario, const DriveFaults& drive) {
  FleetSimulation simulation(scenario, {.timeout = 600, .plan_budget = 0, .faults = {.drive = drive}});
  std::vector<RobotState> said;
  simulation.set_listener([&](const Message& message, double) {
    const auto* state = std::get_if<RobotState>(&message);
    if (state != nullptr && !state->passed_on) said.push_back(*state);
  });
  simulation.run([](const PlannerService&, double) { return true; });
  EXPECT_EQ(simulation.service().report(in_parts(simulation.tracks())).outcome(), "arrived");
  for (const NamedTrack& track : simulation.tracks()) {
    const double furthest = furthest_off(said, track);
    EXPECT_GT(furthest, 0);
    EXPECT_LT(furthest, scenario.robots.front().tracking_tolerance) << track.robot;
  }
  for (const std::string& line : broken_invariants(scenario, simulation)) ADD_FAILURE() << line;
}

/// Once such robots overtook their references by up to three times their tolerances.
TEST(FollowingRobots, RobotsThatBrakeSlowlyKeepWithinTheirTolerances) {
  const RobotTask truck{
      .radius = 1, .max_speed = 8, .max_acceleration = 0.9, .goal_tolerance = 0.5, .tracking_tolerance = 2};
  expect_to_keep_within_tolerances(opposite_rows(truck, 7), largest_drive_faults(truck));
}

TEST(FollowingRobots, DifferentialRobotsArriveWithTheLargestFaults) {
  const RobotTask turtle{.radius = 0.3,
                         .max_speed = 1,
                         .max_acceleration = 2,
                         .goal_tolerance = 0.2,
                         .max_angular_speed = 2,
                         .max_angular_acceleration = 8,
                         .goal_yaw = 1,
                         .goal_yaw_tolerance = 0.1,
                         .tracking_tolerance = 0.25};
  expect_to_keep_within_tolerances(opposite_rows(turtle, 2), largest_drive_faults(turtle));
}

/// Once such robots were refused: at full speed a wheel that slips turned them faster than they could steer.
TEST(FollowingRobots, FastRobotsThatTurnSlowlyKeepWithinTheirTolerancesWithSlip) {
  const RobotTask racer{.radius = 0.3,
                        .max_speed = 15,
                        .max_acceleration = 250,
                        .goal_tolerance = 0.1,
                        .max_angular_speed = 0.9,
                        .max_angular_acceleration = 6,
                        .tracking_tolerance = 1};
  expect_to_keep_within_tolerances(opposite_rows(racer, 7), {.lag = 0.06, .slip = 0.08});
}

/// Once a robot that stands did not turn for less than 0.02 rad, and such a robot never arrived.
TEST(FollowingRobots, ARobotComesToAYawThatIsAskedForExactly) {
  const RobotTask turtle{.radius = 0.3,
                         .max_speed = 1,
                         .max_acceleration = 2,
                         .goal_tolerance = 0.2,
                         .max_angular_speed = 2,
                         .max_angular_acceleration = 8,
                         .goal_yaw = -2,
                         .goal_yaw_tolerance = 0.01,
                         .tracking_tolerance = 0.25};
  expect_to_keep_within_tolerances(opposite_rows(turtle, 2), {.lag = 0.1});
}

}  // namespace
}  // namespace coppice
