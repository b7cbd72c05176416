#include "simulation/fleet_simulation.h"

#include <set>

#include <gtest/gtest.h>

#include "coppice/files/scenario_file.h"
#include "coppice/files/scenario_generator.h"
#include "coppice/planning/clearance_field.h"
#include "tests/support.h"
#include "tests/tracks.h"

namespace coppice {
namespace {

struct Result {
  std::string report;
  std::vector<std::vector<TrackPoint>> tracks;
  proto::Report figures;
};

Result result_of(const Scenario& scenario, const SimulationSettings& settings = {}) {
  FleetSimulation simulation(scenario, settings);
  simulation.run([](const PlannerService&, double) { return true; });
  return {simulation.service().report().SerializeAsString(), test::all_points(simulation.service().tracks()),
          simulation.service().report()};
}

TEST(FleetSimulation, AllRobotsArriveAndNoneTouchesAnything) {
  const Scenario scenario = read_scenario(test::scenarios() / "rooms-8.json", {});
  const Result result = result_of(scenario);
  EXPECT_EQ(result.figures.outcome(), "arrived");
  EXPECT_EQ(result.figures.collisions(), 0u);
  EXPECT_GE(result.figures.least_separation(), 0);
  EXPECT_GE(result.figures.least_clearance(), -overlap_tolerance);
  EXPECT_GT(result.figures.trees_published(), 0u);
  EXPECT_GT(result.figures.trees_grafted(), 0u);
}

// As in the paper: while root trees grow in the agents, the broker freezes and publishes trees that they
// meet.
TEST(FleetSimulation, TreesThatGrowTogetherWithTheRootTreesArePublishedOneAfterTheOther) {
  const Scenario scenario = read_scenario(test::scenarios() / "maze-10.json", {});
  FleetSimulation simulation(scenario, {.timeout = 5, .forest = ForestStart::together});
  std::set<double> published_at;
  double missions_at = -1;
  simulation.set_listener([&](const Message& message, double now) {
    if (std::holds_alternative<InactiveTreesMessage>(message)) published_at.insert(now);
    if (std::holds_alternative<Mission>(message) && missions_at < 0) missions_at = now;
  });
  simulation.run([](const PlannerService&, double) { return true; });
  const proto::Report report = simulation.service().report();
  for (const auto& robot : report.robots()) EXPECT_TRUE(robot.planned()) << robot.name();
  std::uint32_t nodes_of_agents = 0;
  for (const auto& robot : report.robots()) nodes_of_agents += robot.nodes_valid();
  EXPECT_GT(nodes_of_agents, 0u);
  EXPECT_GT(published_at.size(), 1u);
  EXPECT_GE(*published_at.begin(), missions_at);
}

TEST(FleetSimulation, TheSameSeedGivesTheSameBytesAndAnotherDoesNot) {
  Scenario scenario = read_scenario(test::scenarios() / "rooms-8.json", {.robots = 4});
  const Result first = result_of(scenario, {.timeout = 30});
  const Result second = result_of(scenario, {.timeout = 30});
  EXPECT_EQ(first.report, second.report);
  ASSERT_EQ(first.tracks.size(), second.tracks.size());
  for (std::size_t i = 0; i < first.tracks.size(); ++i) {
    const auto& a = first.tracks[i];
    const auto& b = second.tracks[i];
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) ASSERT_EQ(a[k].position, b[k].position);
  }
  scenario.seed += 1;
  EXPECT_NE(result_of(scenario, {.timeout = 30}).report, first.report);
}

// The limits hold at every recorded step, and the track has no gaps.
TEST(FleetSimulation, SpeedAndAccelerationStayWithinTheLimits) {
  const Scenario scenario = read_scenario(test::scenarios() / "dense-8.json", {});
  const Result result = result_of(scenario, {.timeout = 60});
  for (std::size_t i = 0; i < result.tracks.size(); ++i) {
    const RobotTask& task = scenario.robots[i];
    const auto& points = result.tracks[i];
    ASSERT_GT(points.size(), 100u);
    EXPECT_EQ(points.front().position, task.start);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double dt = points[k].time - points[k - 1].time;
      ASSERT_NEAR(dt, 0.05, 1e-6);
      ASSERT_LE((points[k].position - points[k - 1].position).norm(), task.max_speed * dt * (1 + 1e-6));
      ASSERT_LE((points[k].velocity - points[k - 1].velocity).norm(),
                task.max_acceleration * dt * (1 + 1e-6));
    }
  }
}

TEST(FleetSimulation, AnUnreachableGoalIsReportedAndTheOthersArrive) {
  Scenario scenario;
  scenario.map.width = 120;
  scenario.map.height = 60;
  scenario.map.blocked.assign(7200, 0);
  for (int j = 0; j < 60; ++j) scenario.map.blocked[static_cast<std::size_t>(j * 120 + 60)] = 1;
  const auto task = [](const char* name, Point2 start, Point2 goal) {
    return RobotTask{name, start, goal, 5, 20, 40, 1};
  };
  scenario.robots = {task("walled-off", {20, 20}, {100, 20}), task("free", {10, 45}, {45, 45})};
  const Result result = result_of(scenario);
  EXPECT_EQ(result.figures.outcome(), "incomplete");
  EXPECT_FALSE(result.figures.robots(0).planned());
  EXPECT_NE(result.figures.robots(0).reason().find("no path"), std::string::npos);
  EXPECT_TRUE(result.figures.robots(1).arrived());
}

/// Copies for unsynchronised peers were once a quarter of all states: 44 states a control period.
TEST(FleetSimulation, HandshakesOfALargeFleetStayFew) {
  FleetSimulation simulation(make_scenario("rooms", 50, 1), {.timeout = 5});
  simulation.run([](const PlannerService&, double) { return true; });
  double states = 0;
  double periods = 0;
  const proto::Report report = simulation.service().report(in_parts(simulation.tracks()));
  for (const auto& robot : report.robots()) {
    states += robot.load().states_received();
    periods += robot.load().periods();
  }
  ASSERT_GT(periods, 0);
  EXPECT_LT(states / periods, 36);
}

}  // namespace
}  // namespace coppice
