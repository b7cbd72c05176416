// Tests of fleets that reciprocal avoidance alone would never bring to their goals: all robots arrive, and
// none touches anything.
#include <ostream>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "coppice/files/scenario_generator.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

struct Trial {
  std::string name;
  int robots;
  int seeds;
};

/// The name that GoogleTest prints.
void PrintTo(const Trial& trial, std::ostream* out) {
  *out << trial.robots << ' ' << trial.name << ", " << trial.seeds << " seeds";
}

class CoordinationTest : public testing::TestWithParam<Trial> {};

TEST_P(CoordinationTest, AllRobotsArriveAndNoneTouchesAnything) {
  const Trial& trial = GetParam();
  for (int seed = 1; seed <= trial.seeds; ++seed) {
    const Scenario scenario = make_scenario(trial.name, trial.robots, static_cast<std::uint32_t>(seed));
    FleetSimulation simulation(scenario, {.timeout = 3000});
    simulation.run([](const PlannerService&, double) { return true; });
    const proto::Report report = simulation.service().report();
    EXPECT_EQ(report.outcome(), "arrived") << trial.name << " seed " << seed;
    EXPECT_GE(report.least_separation(), 0) << trial.name << " seed " << seed;
    EXPECT_GE(report.least_clearance(), -overlap_tolerance) << trial.name << " seed " << seed;
    EXPECT_EQ(simulation.suffered().rejected, 0u) << trial.name << " seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenarios, CoordinationTest,
                         testing::Values(Trial{"circle", 10, 20}, Trial{"circle", 50, 5},
                                         Trial{"circle", 100, 1}, Trial{"pocket-14", 2, 20},
                                         Trial{"pocket-18", 2, 20}, Trial{"loop-14", 2, 20},
                                         Trial{"loop-18", 2, 20}, Trial{"corridor-24", 10, 20},
                                         Trial{"corridor-40", 20, 20}, Trial{"door-14", 10, 20},
                                         Trial{"door-20", 20, 20}, Trial{"crossing", 40, 3},
                                         Trial{"rooms", 20, 20}, Trial{"rooms", 50, 2}, Trial{"maze", 10, 10},
                                         Trial{"maze", 20, 5}, Trial{"warehouse", 30, 10},
                                         Trial{"dead-end", 6, 20}, Trial{"mixed", 30, 2}),
                         [](const auto& trial) {
                           std::string name = trial.param.name + "_" + std::to_string(trial.param.robots);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

void expect_all_arrive(const Scenario& scenario) {
  FleetSimulation simulation(scenario, {.timeout = 600});
  simulation.run([](const PlannerService&, double) { return true; });
  EXPECT_EQ(simulation.service().report().outcome(), "arrived");
  EXPECT_TRUE(broken_invariants(scenario, simulation).empty());
}

/// A robot with a radius of 5 m.
RobotTask task(std::size_t number, const Point2& start, const Point2& goal) {
  return {"r" + std::to_string(number + 1), start, goal, 5, 20, 40, 1};
}

// The robot that arrives first stands in the way of robots whose goals lie deeper.
TEST(FleetCoordination, AnAisleIsFilledWithRobotsThatAlmostTouch) {
  for (const double distance : {10.0, 10.5, 12.0}) {
    SCOPED_TRACE(distance);
    OccupancyMap map = test::open_map(300, 100);
    test::block(map, 100, 0, 300, 100);
    test::block(map, 100, 43, 290, 57, false);
    Scenario scenario{.map_name = "aisle", .map = map, .seed = 1, .robots = {}};
    for (std::size_t k = 0; k < 6; ++k) {
      const Point2 start(20 + 25 * static_cast<double>(k % 3), 20 + 25 * static_cast<double>(k / 3));
      scenario.robots.push_back(task(k, start, {220 + distance * static_cast<double>(k), 50}));
    }
    expect_all_arrive(scenario);
  }
}

// A robot that arrived a little off its goal may take room that another needs.
TEST(FleetCoordination, GoalsMayTouch) {
  Scenario scenario{.map_name = "open", .map = test::open_map(300, 200), .seed = 1, .robots = {}};
  for (std::size_t k = 0; k < 8; ++k) {
    const auto column = static_cast<double>(k);
    scenario.robots.push_back(task(k, {30 + 20 * column, 30}, {100 + 10 * column, 150}));
  }
  expect_all_arrive(scenario);
}

// Each robot gets a new goal on arrival.
TEST(FleetCoordination, ALifelongFleetKeepsGettingGoals) {
  for (const char* name : {"rooms", "maze"}) {
    const Scenario scenario = make_scenario(name, 20, 1);
    FleetSimulation simulation(scenario, {.timeout = 3000, .lifelong = 200});
    simulation.run([](const PlannerService&, double) { return true; });
    const proto::Report report = simulation.service().report();
    EXPECT_EQ(report.outcome(), "arrived") << name;
    EXPECT_GE(report.missions(), 30u) << name;  // one more mission for every second robot
    EXPECT_TRUE(broken_invariants(scenario, simulation).empty()) << name;
  }
}

// Two robots meet head-on in a corridor without a pocket. They are told within a bounded time that there is
// no plan.
TEST(FleetCoordination, AMissingJointPlanIsReported) {
  Scenario scenario;
  scenario.map = {.width = 240, .height = 34, .blocked = std::vector<std::uint8_t>(240 * 34, 1)};
  for (int j = 10; j < 24; ++j) {
    for (int i = 10; i < 230; ++i) scenario.map.blocked[static_cast<std::size_t>(j * 240 + i)] = 0;
  }
  scenario.robots = {{"a", {20, 17}, {220, 17}, 5, 20, 40, 1}, {"b", {220, 17}, {20, 17}, 5, 20, 40, 1}};
  FleetSimulation simulation(scenario, {.timeout = 3000});
  double ended = 0;
  simulation.run([&](const PlannerService&, double now) {
    ended = now;
    return true;
  });
  const proto::Report report = simulation.service().report();
  EXPECT_EQ(report.outcome(), "incomplete");
  EXPECT_LT(ended, 120);
  EXPECT_GE(report.least_separation(), 0);
  for (const auto& robot : report.robots())
    EXPECT_NE(robot.reason().find("was not found within"), std::string::npos) << robot.reason();
}

TEST(FleetCoordination, UnknownKindsAndTooManyRobotsAreErrors) {
  EXPECT_THROW(make_scenario("nothing", 2, 1), InputError);
  EXPECT_THROW(make_scenario("rooms", 100'000, 1), InputError);
  for (const ScenarioKind& kind : scenario_kinds()) {
    if (kind.most < 1000) {
      EXPECT_EQ(make_scenario(kind.name, kind.most, 1).robots.size(), static_cast<std::size_t>(kind.most))
          << kind.name;
      EXPECT_THROW(make_scenario(kind.name, kind.most + 1, 1), InputError) << kind.name;
    }
  }
}

}  // namespace
}  // namespace coppice
