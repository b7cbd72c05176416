// Tests of fleets without reservations: robots drive along their paths by reciprocal velocity obstacles, and
// sort themselves out in coordination rounds where they get stuck.
#include <algorithm>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "coppice/files/map_file.h"
#include "coppice/files/scenario_generator.h"
#include "coppice/planning/map_generator.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

RobotTask task(const std::string& name, const Point2& start, const Point2& goal) {
  return {name, start, goal, 5, 20, 40, 1};
}

/// Random tasks on a kind of map of the paper.
Scenario on_map(const std::string& kind, int robots, std::uint32_t seed) {
  Random random(seed);
  Scenario scenario{
      .map_name = kind, .map = read_or_generate_map(kind, 512, 512, random), .seed = seed, .robots = {}};
  for (const auto& [start, goal] : random_tasks(ClearanceField(scenario.map), robots, 5, 0.4, random))
    scenario.robots.push_back(task("r" + std::to_string(scenario.robots.size() + 1), start, goal));
  return scenario;
}

struct Driven {
  proto::Report report;
  int joint_plans = 0;
  int trajectories = 0;  ///< reservations that are no parts of joint plans
};

/// Nothing touches anything, whatever else happens.
Driven driven(const Scenario& scenario, SimulationSettings settings) {
  if (reserves(settings.coordination)) settings.coordination = Coordination::rvo;
  FleetSimulation simulation(scenario, settings);
  Driven result;
  simulation.set_listener([&](const Message& message, double) {
    result.joint_plans += std::holds_alternative<JointPlanMessage>(message);
    const auto* const r = std::get_if<ReservationMessage>(&message);
    result.trajectories += r != nullptr && !r->trajectory.empty() && r->plan.leader.empty();
  });
  simulation.run([](const PlannerService&, double) { return true; });
  result.report = simulation.service().report(in_parts(simulation.tracks()));
  for (const std::string& line : broken_invariants(scenario, simulation)) ADD_FAILURE() << line;
  return result;
}

void expect_all_arrive(const Scenario& scenario, const SimulationSettings& settings = {.timeout = 600}) {
  const Driven fleet = driven(scenario, settings);
  EXPECT_EQ(fleet.report.outcome(), "arrived");
  EXPECT_EQ(fleet.trajectories, 0);
}

TEST(VelocityObstacles, AllRobotsArriveOnBlankMaps) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    expect_all_arrive(on_map("blank", 20, seed));
  }
}
TEST(VelocityObstacles, AllRobotsArriveInRooms) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    expect_all_arrive(on_map("room", 10, seed));
    expect_all_arrive(make_scenario("rooms", 10, seed));
  }
}
TEST(VelocityObstacles, AllRobotsArriveOnTheOtherSideOfACircle) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    expect_all_arrive(make_scenario("circle", 10, seed));
  }
}

TEST(VelocityObstacles, NothingTouchesAlthoughStatesAreLostAndLate) {
  const SimulationSettings settings{.timeout = 300, .faults = {.bus = {.loss = 0.3, .delay = 0.2}}};
  driven(make_scenario("circle", 10, 1), settings);
  driven(make_scenario("rooms", 10, 2), settings);
}

TEST(VelocityObstacles, DifferentialRobotsArriveToo) {
  Scenario scenario = on_map("room", 6, 3);
  for (RobotTask& robot : scenario.robots) {
    robot.max_angular_speed = 0.8 * robot.max_speed / robot.radius;
    robot.max_angular_acceleration = 2 * robot.max_angular_speed;
  }
  expect_all_arrive(scenario);
}

TEST(VelocityObstacles, ALifelongFleetKeepsGettingGoals) {
  const Driven fleet = driven(make_scenario("rooms", 10, 1), {.timeout = 1000, .lifelong = 60});
  EXPECT_EQ(fleet.report.outcome(), "arrived");
  EXPECT_GE(fleet.report.missions(), 20u);
}

/// Two robots that want to pass each other where there is room for one. They meet far from the only bay.
Scenario corridor_with_bay() {
  OccupancyMap map = test::open_map(240, 60);
  test::block(map, 0, 0, 240, 60);
  test::block(map, 10, 10, 230, 24, false);
  test::block(map, 40, 24, 70, 44, false);
  return {.map_name = "bay",
          .map = map,
          .seed = 1,
          .robots = {task("a", {20, 17}, {220, 17}), task("b", {220, 17}, {20, 17})}};
}

TEST(VelocityObstacles, RobotsThatAreStuckMakeAJointPlan) {
  const Driven fleet = driven(corridor_with_bay(), {.timeout = 120});
  EXPECT_EQ(fleet.report.outcome(), "arrived");
  EXPECT_GE(fleet.joint_plans, 1);
  EXPECT_EQ(fleet.trajectories, 0);
}

TEST(VelocityObstacles, WithoutRoundsRobotsStayStuckAndTheReportSaysSo) {
  const Driven fleet =
      driven(corridor_with_bay(), {.timeout = 60, .coordination = Coordination::rvo_without_rounds});
  EXPECT_EQ(fleet.report.outcome(), "timeout");
  EXPECT_EQ(fleet.joint_plans, 0);
  EXPECT_EQ(fleet.trajectories, 0);
  ASSERT_EQ(fleet.report.robots_size(), 2);
  EXPECT_NE(fleet.report.robots(0).reason().find("b is in the way"), std::string::npos)
      << fleet.report.robots(0).reason();
}

// RRT* finds a way through a maze late, and one along a corridor at once.
TEST(VelocityObstacles, RobotsSetOffWhileOthersStillPlan) {
  Scenario scenario = on_map("maze", 2, 1);
  RobotTask& near = scenario.robots.back();
  const ClearanceField field(scenario.map);
  for (const Point2& step : {Point2(30, 0), Point2(0, 30), Point2(-30, 0), Point2(0, -30)}) {
    if (field.segment_free(near.start, near.start + step, near.radius)) near.goal = near.start + step;
  }
  FleetSimulation simulation(
      scenario, {.timeout = 20, .planner = PlannerKind::rrt_star, .coordination = Coordination::rvo});
  std::map<RobotName, Phase> phases;
  bool one_drives_while_another_plans = false;
  simulation.set_listener([&](const Message& message, double) {
    const auto* const state = std::get_if<RobotState>(&message);
    if (state == nullptr) return;
    phases[state->robot] = state->phase;
    const bool drives = state->phase == Phase::driving && !state->promise.next_velocity.isZero(0);
    one_drives_while_another_plans |=
        drives && std::ranges::any_of(phases, [](const auto& p) { return p.second == Phase::planning; });
  });
  simulation.run([&](const PlannerService&, double) { return !one_drives_while_another_plans; });
  EXPECT_TRUE(one_drives_while_another_plans);
}

}  // namespace
}  // namespace coppice
