// Tests of the public function that simulates a fleet.

#include "coppice/simulation/simulate.h"

#include <cmath>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "coppice/files/scenario_generator.h"

namespace coppice {
namespace {

TEST(Simulate, ARunHasAReportAndATrackForEachRobot) {
  const Scenario scenario = make_scenario("circle", 5, 1);
  const SimulatedRun run = simulate(scenario);
  EXPECT_TRUE(run.arrived);
  EXPECT_TRUE(run.broken.empty());
  ASSERT_EQ(run.tracks.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    const TrackPoint& last = run.tracks[k].points.back();
    EXPECT_LE((last.position - scenario.robots[k].goal).norm(), scenario.robots[k].goal_tolerance);
    EXPECT_GE(last.time, run.run_time - 0.1);
  }
  EXPECT_NE(run.report.find("\"outcome\": \"arrived\""), std::string::npos) << run.report;
}

TEST(Simulate, AStopEndsTheRunEarly) {
  const SimulatedRun run = simulate(make_scenario("circle", 5, 1), {}, [](double now) { return now > 3; });
  EXPECT_FALSE(run.arrived);
  EXPECT_NE(run.report.find("\"outcome\": \"interrupted\""), std::string::npos) << run.report;
}

TEST(Simulate, FaultsThatMakeNoSenseNameTheirField) {
  const auto error = [](auto&& spoil) -> std::string {
    Scenario scenario = make_scenario("circle", 3, 1);
    SimulationSettings settings;
    spoil(scenario, settings);
    try {
      simulate(scenario, settings, [](double) { return true; });
      return "no error";
    } catch (const InputError& problem) {
      return problem.what();
    }
  };
  EXPECT_EQ(error([](auto&, auto&) {}), "no error");
  EXPECT_TRUE(error([](auto&, auto& s) { s.faults.bus.loss = 1; }).starts_with("faults.loss: 1"));
  EXPECT_TRUE(error([](auto&, auto& s) { s.faults.bus.jitter = -1; }).starts_with("faults.jitter: -1"));
  EXPECT_TRUE(error([](auto&, auto& s) { s.faults.pause = std::nan(""); }).starts_with("faults.pause: nan"));
  EXPECT_TRUE(error([](auto&, auto& s) { s.timeout = 0; }).starts_with("timeout: 0"));
  EXPECT_TRUE(error([](auto&, auto& s) { s.faults.kills = {{"x", 1}}; }).starts_with("faults.kills"));
  EXPECT_TRUE(error([](auto& scenario, auto&) { scenario.robots.clear(); }).starts_with("robots: is empty"));
  EXPECT_TRUE(error([](auto& scenario, auto&) {
                scenario.robots[1].start = scenario.robots[0].start;
              }).starts_with("robots[1].start: r2 and r1 would overlap"));
  EXPECT_TRUE(
      error([](auto& scenario, auto&) { scenario.map.blocked.clear(); }).starts_with("map: blocked: 0"));
  EXPECT_TRUE(
      error([](auto& scenario, auto&) { scenario.map.resolution = 0; }).starts_with("map: resolution"));
  EXPECT_TRUE(error([](auto& scenario, auto&) {
                scenario.robots[2].max_acceleration = 0.01;
              }).starts_with("robots[2].max_acceleration: 0.01 takes longer"));
}

TEST(Simulate, APlanGoesWithReservationsOnly) {
  const Scenario scenario = make_scenario("circle", 3, 1);
  SimulationSettings settings{.coordination = Coordination::rvo};
  settings.plan.resize(3);
  EXPECT_THROW(simulate(scenario, settings), InputError);
}

}  // namespace
}  // namespace coppice
