// Tests of fleets that carry out a joint plan that was made elsewhere.
#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "coppice/files/plan_file.h"
#include "coppice/simulation/simulate.h"

namespace coppice {
namespace {

constexpr int cells = 7;

/// A crossing of two corridors, one cell wide: three robots drive to the right, two downwards.
Scenario crossing() {
  Scenario scenario;
  scenario.map_name = "crossing";
  scenario.map = {.width = cells, .height = cells, .blocked = std::vector<std::uint8_t>(cells * cells, 1)};
  for (std::size_t k = 0; k < cells; ++k) {
    scenario.map.blocked[3 * cells + k] = 0;
    scenario.map.blocked[k * cells + 3] = 0;
  }
  const auto add = [&](const char* name, Point2 start, Point2 goal) {
    scenario.robots.push_back({name, start, goal, 0.3, 1, 2, 0.1});
  };
  add("a", {2.5, 3.5}, {6.5, 3.5});
  add("b", {1.5, 3.5}, {5.5, 3.5});
  add("c", {0.5, 3.5}, {4.5, 3.5});
  add("d", {3.5, 2.5}, {3.5, 6.5});
  add("e", {3.5, 1.5}, {3.5, 5.5});
  return scenario;
}

/// Waits at the first cell, then drives `cells` straight on.
std::vector<GridCell> line(GridCell from, GridCell step, int waits, int cells) {
  std::vector<GridCell> all(static_cast<std::size_t>(waits) + 1, from);
  for (int k = 1; k <= cells; ++k) all.push_back({from.x + k * step.x, from.y + k * step.y});
  return all;
}

/// The order at the crossing: d, a, e, b, c. No robot would choose it by itself.
GridPlan plan_of_crossing() {
  return {line({2, 3}, {1, 0}, 1, 4), line({1, 3}, {1, 0}, 3, 4), line({0, 3}, {1, 0}, 3, 4),
          line({3, 2}, {0, 1}, 0, 4), line({3, 1}, {0, 1}, 1, 4)};
}

/// When a robot is first closest to the middle.
double time_at_middle(const Track& track) {
  double least = std::numeric_limits<double>::infinity();
  double time = 0;
  for (const TrackPoint& p : track.points) {
    const double distance = (p.position - Point2(3.5, 3.5)).norm();
    if (distance >= least - 1e-9) continue;
    least = distance;
    time = p.time;
  }
  return time;
}

void expect_order(const SimulatedRun& run) {
  EXPECT_TRUE(run.arrived) << run.report;
  EXPECT_TRUE(run.broken.empty()) << run.broken.front();
  std::vector<double> times;
  for (const std::size_t robot : {3u, 0u, 4u, 1u, 2u}) times.push_back(time_at_middle(run.tracks[robot]));
  EXPECT_TRUE(std::ranges::is_sorted(times)) << testing::PrintToString(times);
}

TEST(GivenPlan, RobotsPassInTheOrderOfThePlan) {
  const Scenario scenario = crossing();
  const SimulatedRun run =
      simulate(scenario, {.timeout = 60, .plan = trajectories_of(plan_of_crossing(), scenario)});
  expect_order(run);
  EXPECT_LT(run.run_time, 12);  // 7 steps of 1 s, and what they lose while they speed up and brake
}

TEST(GivenPlan, ARobotReportsItsPartOfThePlanAsItsPath) {
  const Scenario scenario = crossing();
  GridPlan detour = plan_of_crossing();
  detour[0] = {{2, 3}, {2, 3}, {3, 3}, {4, 3},
               {5, 3}, {6, 3}, {5, 3}, {6, 3}};  // there and back, and there again
  const SimulatedRun run = simulate(scenario, {.timeout = 60, .plan = trajectories_of(detour, scenario)});
  EXPECT_TRUE(run.arrived);
  EXPECT_NE(run.report.find("\"path_length\": 6"), std::string::npos) << run.report;
}

TEST(GivenPlan, RobotsKeepTheOrderOverABadNetwork) {
  const Scenario scenario = crossing();
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    Scenario drawn = scenario;
    drawn.seed = seed;
    Faults faults;
    faults.bus.delay = 0.2;
    faults.bus.jitter = 0.1;
    faults.bus.loss = 0.3;
    expect_order(simulate(
        drawn, {.timeout = 200, .faults = faults, .plan = trajectories_of(plan_of_crossing(), scenario)}));
  }
}

// The others wait for a robot that does not come. Then they plan for themselves.
TEST(GivenPlan, RobotsArriveThoughOneOfThePlanFails) {
  const Scenario scenario = crossing();
  Faults faults;
  faults.kills.push_back({"a", 0.05});
  const SimulatedRun run = simulate(
      scenario, {.timeout = 300, .faults = faults, .plan = trajectories_of(plan_of_crossing(), scenario)});
  EXPECT_TRUE(run.broken.empty()) << run.broken.front();
  for (const std::size_t robot : {3u, 4u})
    EXPECT_LT((run.tracks[robot].points.back().position - scenario.robots[robot].goal).norm(), 0.1) << robot;
}

}  // namespace
}  // namespace coppice
