// Robots that start a little too near to a wall, as localisation has them: they drive out, and the others are
// served meanwhile.
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "coppice/files/scenario_file.h"
#include "coppice/planning/clearance_field.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/support.h"

namespace coppice {
namespace {

using test::TemporaryFolder;

constexpr double radius = 0.4;

std::string room() {
  std::string map = "type octile\nheight 10\nwidth 16\nmap\n";
  for (int j = 0; j < 10; ++j) map += std::string(16, '.') + '\n';
  return map;
}

/// r1 starts that far from the left wall; r2 passes close by.
std::string site(double x, const std::string& fields = "") {
  return R"({"map": "room.map", "radius": 0.4, "max_speed": 1, "goal_tolerance": 0.1, )" + fields +
         R"("robots": [{"name": "r1", "start": {"x": )" + std::to_string(x) +
         R"(, "y": 5}, "goal": {"x": 12, "y": 5}},
                       {"name": "r2", "start": {"x": 2, "y": 8}, "goal": {"x": 2, "y": 2}}]})";
}

Scenario read(const std::string& text, const ScenarioOptions& options = {}) {
  const TemporaryFolder folder;
  folder.write("room.map", room());
  return read_scenario(folder.write("site.json", text), options);
}

std::string error_of(const std::string& text) {
  try {
    read(text);
    return {};
  } catch (const InputError& problem) {
    return problem.what();
  }
}

/// Runs it, and expects that r1's clearance only grows until it is free.
void expect_that_it_drives_out(const Scenario& scenario,
                               const SimulationSettings& settings = {.timeout = 120}) {
  FleetSimulation simulation(scenario, settings);
  simulation.run([](const PlannerService&, double) { return true; });
  const proto::Report report = simulation.service().report();
  EXPECT_EQ(report.outcome(), "arrived") << report.robots(0).reason();
  EXPECT_EQ(report.collisions(), 0u);
  EXPECT_LT(report.least_clearance(), 0) << "the start is told as it is";
  for (const std::string& line : broken_invariants(scenario, simulation)) ADD_FAILURE() << line;
  const ClearanceField field(scenario.map);
  double before = 0;
  for (const TrackPoint& point : simulation.tracks().at(0).track.points) {
    const double clearance = field.clearance(point.position);
    if (clearance >= radius) break;
    EXPECT_GE(clearance, before - 1e-9) << point.time;
    before = clearance;
  }
}

TEST(StartsAtWalls, ARobotThatIsACentimetreTooNearDrivesOutAndArrives) {
  const Scenario scenario = read(site(radius - 0.01));
  ASSERT_TRUE(scenario.robots[0].stands_at);
  EXPECT_EQ(*scenario.robots[0].stands_at, Point2(radius - 0.01, 5));
  EXPECT_GT(scenario.margin, 0) << "the others keep their margin";
  expect_that_it_drives_out(scenario);
}

TEST(StartsAtWalls, SoDoesADifferentialRobotWhateverItsHeading) {
  for (const char* const kinematics :
       {R"("kinematics": "differential", )", R"("kinematics": "differential", "margin": 0, )"})
    expect_that_it_drives_out(read(site(radius - 0.05, kinematics)));
}

TEST(StartsAtWalls, SoDoesOneUnderFaults) {
  Faults faults;
  faults.bus.loss = 0.2;
  faults.bus.delay = 0.1;
  faults.clock_skew = 1;
  for (const double time : {1.5, 3.0, 4.5}) faults.kills.push_back({"r1", time});
  faults.restart_after = 0.5;
  expect_that_it_drives_out(read(site(radius - 0.09)), {.timeout = 200, .faults = faults});
}

TEST(StartsAtWalls, AStartThatIsTooNearByItsToleranceIsRefusedByName) {
  EXPECT_NE(
      error_of(site(radius - 0.11)).find("robots[0].start: (0.29, 5) is inside of an obstacle or too near"),
      std::string::npos)
      << error_of(site(radius - 0.11));
  EXPECT_EQ(error_of(site(radius - 0.09)), "");
}

TEST(StartsAtWalls, ARobotWithoutAGoalStaysWhereItHasRoom) {
  const std::string text =
      R"({"map": "room.map", "radius": 0.4, "goal_tolerance": 0.1, "margin": 0.04,
          "robots": [{"name": "r1", "start": {"x": 0.39, "y": 5}}]})";
  for (const bool follow : {false, true}) {
    const Scenario scenario = read(text, {.follow = follow, .is_site = true});
    const RobotTask& robot = scenario.robots[0];
    EXPECT_EQ(robot.stands_at, Point2(0.39, 5));
    EXPECT_EQ(robot.goal, robot.start);
    EXPECT_TRUE(ClearanceField(scenario.map, scenario.margin).is_free(robot.goal, driving_radius(robot)));
  }
}

TEST(StartsAtWalls, StartsThatOverlapEachOtherAreRefusedByName) {
  const std::string close =
      R"({"map": "room.map", "radius": 0.4, "max_speed": 1, "goal_tolerance": 0.1, "robots": [
        {"name": "r1", "start": {"x": 0.39, "y": 5}, "goal": {"x": 12, "y": 5}},
        {"name": "r2", "start": {"x": 1.18, "y": 5}, "goal": {"x": 2, "y": 2}}]})";
  EXPECT_NE(error_of(close).find(
                "robots[1].start: r2 and r1 would overlap there: distance 0.78, sum of their radii 0.8"),
            std::string::npos)
      << error_of(close);
}

TEST(StartsAtWalls, TheReferenceOfAFollowingRobotStartsWhereItIsFree) {
  const Scenario scenario = read(site(radius - 0.02), {.follow = true, .tracking_tolerance = 0.1});
  const RobotTask& robot = scenario.robots[0];
  EXPECT_GT(robot.tracking_tolerance, 0.05);
  EXPECT_TRUE(ClearanceField(scenario.map).is_free(robot.start, reference_radius(robot)));
  EXPECT_EQ(body_begins_at(robot), robot.start);
  Faults faults;
  faults.drive = {.odometry_noise = 0.01, .lag = 0.1};
  FleetSimulation simulation(scenario, {.timeout = 200, .faults = faults});
  simulation.run([](const PlannerService&, double) { return true; });
  EXPECT_EQ(simulation.service().report().outcome(), "arrived");
}

}  // namespace
}  // namespace coppice
