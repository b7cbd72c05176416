#include "coppice/files/scenario_file.h"

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "coppice/files/map_file.h"
#include "planning/quantities.h"
#include "tests/support.h"

namespace coppice {
namespace {

using test::TemporaryFolder;

const char* const small_map = "type octile\nheight 4\nwidth 6\nmap\n......\n..@@..\n..@@..\n......\n";
const char* const two_robots =
    R"("robots": [{"name": "a", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}},
                  {"name": "b", "start": {"x": 1, "y": 3}, "goal": {"x": 5, "y": 3}}])";

/// The error message of reading this scenario; empty if it is read.
std::string error_of(const std::string& json, const std::string& map = small_map,
                     const ScenarioOptions& options = {}) {
  const TemporaryFolder folder;
  folder.write("small.map", map);
  try {
    read_scenario(folder.write("fleet.json", json), options);
  } catch (const InputError& problem) {
    const std::string text = problem.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << "one line: " << text;
    return text;
  }
  return {};
}

std::string scenario(const std::string& fields) {
  return std::string(R"({"map": "small.map", "radius": 0.5, )") + fields + "}";
}

TEST(ScenarioFile, FieldsAreReadAndDefaultsFilledIn) {
  const TemporaryFolder folder;
  folder.write("small.map", small_map);
  const auto file = folder.write("fleet.json", R"({"map": "small.map", "radius": 0.5, "seed": 7,
      "robots": [{"name": "a", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}},
                 {"name": "b", "start": {"x": 1, "y": 3}, "goal": {"x": 5, "y": 3}, "radius": 0.25, "max_speed": 3}]})");
  const Scenario s = read_scenario(file, {});
  ASSERT_EQ(s.robots.size(), 2u);
  EXPECT_EQ(s.seed, 7u);
  EXPECT_EQ(s.robots[0].name, "a");
  EXPECT_EQ(s.robots[0].start, Point2(1, 1));
  EXPECT_EQ(s.robots[0].goal, Point2(5, 1));
  EXPECT_EQ(s.robots[0].radius, 0.5);
  EXPECT_EQ(s.robots[0].max_speed, 20);
  EXPECT_EQ(s.robots[0].max_acceleration, 40);
  EXPECT_EQ(s.robots[0].goal_tolerance, 1);
  EXPECT_EQ(s.robots[1].radius, 0.25);
  EXPECT_EQ(s.robots[1].max_speed, 3);
  EXPECT_EQ(s.robots[1].max_acceleration, 6);
}

TEST(ScenarioFile, RobotsMayBeDifferentialAllOrSingly) {
  const TemporaryFolder folder;
  folder.write("small.map", small_map);
  const auto file = folder.write("fleet.json", R"({"map": "small.map", "radius": 0.25, "max_speed": 1,
      "kinematics": "differential", "goal_yaw_tolerance": 0.2,
      "robots": [{"name": "a", "start": {"x": 1, "y": 1, "yaw": 1.5}, "goal": {"x": 5, "y": 1, "yaw": -0.5}},
                 {"name": "b", "start": {"x": 1, "y": 3}, "goal": {"x": 5, "y": 3}, "max_angular_speed": 2},
                 {"name": "c", "start": {"x": 1, "y": 2}, "goal": {"x": 5, "y": 2}, "kinematics": "holonomic"}]})");
  const Scenario s = read_scenario(file, {});
  EXPECT_EQ(s.robots[0].max_angular_speed, 4);  // full speed of both wheels
  EXPECT_EQ(s.robots[0].max_angular_acceleration, 8);
  EXPECT_EQ(s.robots[0].start_yaw, 1.5);
  EXPECT_EQ(s.robots[0].goal_yaw, -0.5);
  EXPECT_EQ(s.robots[0].goal_yaw_tolerance, 0.2);
  EXPECT_EQ(s.robots[1].max_angular_speed, 2);
  EXPECT_EQ(s.robots[1].goal_yaw_tolerance, 0) << "any yaw";
  EXPECT_FALSE(is_differential(limits_of(s.robots[2])));
  EXPECT_FALSE(is_differential(limits_of(read_scenario(file, {.kinematics = "holonomic"}).robots[0])));
  EXPECT_TRUE(is_differential(limits_of(read_scenario(file, {.kinematics = "differential"}).robots[2])));

  write_scenario(folder.path() / "again.json", s);
  const Scenario again = read_scenario(folder.path() / "again.json", {});
  for (std::size_t i = 0; i < s.robots.size(); ++i) {
    EXPECT_EQ(again.robots[i].max_angular_speed, s.robots[i].max_angular_speed);
    EXPECT_EQ(again.robots[i].start_yaw, s.robots[i].start_yaw);
    EXPECT_EQ(again.robots[i].goal_yaw, s.robots[i].goal_yaw);
    EXPECT_EQ(again.robots[i].goal_yaw_tolerance, s.robots[i].goal_yaw_tolerance);
  }
}

// From half a turn in a control period on, a chord says little of its arc.
TEST(ScenarioFile, ARobotTurnsByAtMostHalfATurnInAControlPeriod) {
  const auto fleet = [](const std::string& fields) {
    return scenario(R"("kinematics": "differential", )" + fields + ", " + two_robots);
  };
  const TemporaryFolder folder;
  folder.write("small.map", small_map);
  const auto read = [&](const std::string& json) {
    return read_scenario(folder.write("fleet.json", json), {}).robots[0];
  };
  EXPECT_EQ(read(fleet(R"("max_speed": 31)")).max_angular_speed, 62);
  EXPECT_EQ(read(fleet(R"("max_speed": 40)")).max_angular_speed, fastest_turning) << "80 by its wheels";
  EXPECT_EQ(read(fleet(R"("max_angular_speed": 62)")).max_angular_speed, 62);
  EXPECT_NE(error_of(fleet(R"("max_angular_speed": 63)"))
                .find("max_angular_speed: 63 turns by more than half a turn in a control period, expected at "
                      "most 62.83"),
            std::string::npos)
      << error_of(fleet(R"("max_angular_speed": 63)"));
  const std::string single = scenario(
      R"("kinematics": "differential", "robots": [{"name": "a", "start": {"x": 1, "y": 1},
         "goal": {"x": 5, "y": 1}, "max_angular_speed": 100}])");
  EXPECT_NE(error_of(single).find("robots[0].max_angular_speed: 100 turns by more"), std::string::npos)
      << error_of(single);
}

/// A hall of 30 x 20 cells with a wall in the middle that leaves `gap` cells.
std::string hall(int gap) {
  std::string map = "type octile\nheight 20\nwidth 30\nmap\n";
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 30; ++i) map += i >= 14 && i < 16 && j >= gap ? '@' : '.';
    map += '\n';
  }
  return map;
}

Scenario in_hall(int gap, const std::string& fields, const ScenarioOptions& options = {}) {
  const TemporaryFolder folder;
  folder.write("hall.map", hall(gap));
  return read_scenario(folder.write("fleet.json", R"({"map": "hall.map", )" + fields + R"(,
      "robots": [{"name": "a", "start": {"x": 5, "y": 10}, "goal": {"x": 25, "y": 10}}]})"),
                       options);
}

TEST(ScenarioFile, TheMarginIsATenthOfTheRadiusWherePassagesLeaveRoom) {
  EXPECT_DOUBLE_EQ(in_hall(8, R"("radius": 2)").margin, 0.2);
  EXPECT_DOUBLE_EQ(in_hall(8, R"("radius": 2, "margin": 0.5)").margin, 0.5);
  EXPECT_DOUBLE_EQ(in_hall(8, R"("radius": 2, "margin": 0.5)", {.margin = 0.1}).margin, 0.1);
  EXPECT_EQ(in_hall(8, R"("radius": 2, "margin": 0)").margin, 0);
  EXPECT_EQ(in_hall(4, R"("radius": 2)").margin, 0) << "the passage is as wide as the robot";
  EXPECT_DOUBLE_EQ(in_hall(5, R"("radius": 2, "margin": 1)").margin, 0.5) << "less where there is less room";
  EXPECT_DOUBLE_EQ(in_hall(8, R"("radius": 4, "margin": 4)").margin, 0) << "the passage has no room for any";
}

TEST(ScenarioFile, AStartWithoutRoomLimitsTheMargin) {
  const TemporaryFolder folder;
  folder.write("hall.map", hall(20));
  const auto file = folder.write("fleet.json", R"({"map": "hall.map", "radius": 2, "margin": 1,
      "robots": [{"name": "a", "start": {"x": 2.6, "y": 10}, "goal": {"x": 25, "y": 10}}]})");
  EXPECT_DOUBLE_EQ(read_scenario(file, {}).margin, 0.5);
}

TEST(ScenarioFile, ARobotThatFollowsIsOffByItsRadiusAtMost) {
  const TemporaryFolder folder;
  folder.write("hall.map", hall(20));
  const auto file = folder.write("fleet.json", R"({"map": "hall.map", "radius": 1, "max_speed": 20,
      "robots": [{"name": "a", "start": {"x": 10, "y": 10}, "goal": {"x": 20, "y": 10}}]})");
  EXPECT_DOUBLE_EQ(read_scenario(file, {.follow = true}).robots[0].tracking_tolerance, 1);
}

TEST(ScenarioFile, RobotsThatFollowGetAsMuchToleranceAsTheirEndsLeave) {
  const TemporaryFolder folder;
  folder.write("hall.map", hall(20));
  const auto file = folder.write("fleet.json", R"({"map": "hall.map", "radius": 1, "max_speed": 2,
      "robots": [{"name": "a", "start": {"x": 5, "y": 5}, "goal": {"x": 25, "y": 5}},
                 {"name": "b", "start": {"x": 5, "y": 15}, "goal": {"x": 28.8, "y": 15}},
                 {"name": "c", "start": {"x": 10, "y": 15}, "goal": {"x": 20, "y": 12.6}},
                 {"name": "d", "start": {"x": 10, "y": 17.4}, "goal": {"x": 20, "y": 18}}]})");
  const Scenario s = read_scenario(file, {.follow = true});
  EXPECT_DOUBLE_EQ(s.robots[0].tracking_tolerance, 0.5) << "a quarter of a second at full speed";
  EXPECT_NEAR(s.robots[1].tracking_tolerance, 0.2, 1e-5) << "its goal is close to the border";
  EXPECT_NEAR(s.robots[2].tracking_tolerance, 0.2, 1e-5) << "its start is close to that of d";
  EXPECT_EQ(s.margin, 0);
  EXPECT_EQ(read_scenario(file, {}).robots[0].tracking_tolerance, 0);
  try {
    read_scenario(file, {.follow = true, .tracking_tolerance = 3});
    FAIL();
  } catch (const InputError& problem) {
    EXPECT_NE(std::string(problem.what()).find("robots[1]: its start, goal or way leaves b no room"),
              std::string::npos)
        << problem.what();
  }
}

TEST(ScenarioFile, AFootprintGivesTheRadiusOfTheDiscThatHoldsIt) {
  const std::string box =
      R"([{"x": 0.8, "y": 0.6}, {"x": -0.4, "y": 0.6}, {"x": -0.4, "y": -0.6}, {"x": 0.8, "y": -0.6}])";
  const Scenario s = in_hall(8, R"("footprint": )" + box);
  EXPECT_DOUBLE_EQ(s.robots[0].radius, 1);
  ASSERT_EQ(s.robots[0].footprint.size(), 4u);
  EXPECT_EQ(s.robots[0].footprint[1], Point2(-0.4, 0.6));
  const TemporaryFolder folder;
  folder.write("hall.map", hall(8));
  write_scenario(folder.path() / "again.json", s);
  EXPECT_EQ(read_scenario(folder.path() / "again.json", {.map = (folder.path() / "hall.map").string()})
                .robots[0]
                .footprint,
            s.robots[0].footprint);
  EXPECT_TRUE(in_hall(8, R"("footprint": )" + box, {.radius = 1.5}).robots[0].footprint.empty());
}

TEST(ScenarioFile, AFootprintThatIsNoneIsNamed) {
  const auto error = [&](const std::string& fields) { return error_of(scenario(fields + two_robots)); };
  const auto names = [](const std::string& text, const std::string& what) {
    EXPECT_NE(text.find(what), std::string::npos) << text;
  };
  const std::string crossing =
      R"("map": "small.map", "footprint": [{"x": 1, "y": 1}, {"x": -1, "y": -1}, {"x": 1, "y": -1}, {"x": -1, "y": 1}], )";
  names(error_of("{" + crossing + two_robots + "}"), "footprint: is no polygon");
  const std::string beside =
      R"("map": "small.map", "footprint": [{"x": 1, "y": 1}, {"x": 2, "y": 1}, {"x": 1, "y": 2}], )";
  names(error_of("{" + beside + two_robots + "}"), "footprint: does not hold (0, 0)");
  const std::string line = R"("map": "small.map", "footprint": [{"x": 1, "y": 1}, {"x": -1, "y": -1}], )";
  names(error_of("{" + line + two_robots + "}"), "footprint: has 2 corners, expected 3 to 64");
  names(error(R"("footprint": [{"x": 1, "y": 1}], )"), "footprint: goes without radius");
  const std::string half =
      R"("map": "small.map", "footprint": [{"x": 1}, {"x": 0, "y": 1}, {"x": -1, "y": -1}], )";
  names(error_of("{" + half + two_robots + "}"), "footprint: a corner lacks x or y");
  const std::string turned = R"("map": "small.map", "footprint": [{"x": 1, "y": 0, "yaw": 1.57}], )";
  names(error_of("{" + turned + two_robots + "}"),
        "footprint[0]: \"yaw\" is not a field, expected one of x, y");
  const std::string pairs = R"("map": "small.map", "footprint": [[0.4, 0.2], [0.4, -0.2], [-0.3, 0]], )";
  names(error_of("{" + pairs + two_robots + "}"),
        R"(footprint[0]: expected {"x": ..., "y": ...}, found a list)");
  const std::string own = R"("robots": [{"name": "a", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1},
                             "footprint": [{"x": 1, "y": 0, "yaw": 1}]}])";
  names(error_of("{\"map\": \"small.map\", " + own + "}"), "robots[0].footprint[0]: \"yaw\" is not a field");
  names(error(R"("margin": -1, )"), "margin: -1 is not allowed");
}

TEST(ScenarioFile, TheCommandLineOverridesTheFile) {
  const TemporaryFolder folder;
  folder.write("small.map", small_map);
  const auto file = folder.write("fleet.json", scenario(two_robots));
  const Scenario s = read_scenario(file, {.robots = 1, .radius = 0.1, .max_speed = 2, .seed = 9});
  ASSERT_EQ(s.robots.size(), 1u);
  EXPECT_EQ(s.robots[0].radius, 0.1);
  EXPECT_EQ(s.robots[0].max_speed, 2);
  EXPECT_EQ(s.seed, 9u);
}

TEST(ScenarioFile, AScenFilePutsRobotsAtCellCentres) {
  const TemporaryFolder folder;
  folder.write("small.map", small_map);
  const auto file = folder.write(
      "fleet.scen", "version 1\n0\tsmall.map\t6\t4\t0\t0\t5\t3\t0\n0\tsmall.map\t6\t4\t5\t0\t0\t3\t0\n");
  const Scenario s = read_scenario(file, {.radius = 0.5});
  ASSERT_EQ(s.robots.size(), 2u);
  EXPECT_EQ(s.robots[0].name, "r1");
  EXPECT_EQ(s.robots[0].start, Point2(0.5, 0.5));
  EXPECT_EQ(s.robots[1].goal, Point2(0.5, 3.5));
}

TEST(ScenarioFile, EveryMistakeIsNamed) {
  const std::vector<std::array<std::string, 2>> cases{
      {R"({"robots": []})", "map: is missing"},
      {R"({"map": "other.map", )" + std::string(two_robots) + "}", "fleet.json: map: there is no "},
      {scenario(R"("robots": [])"), "robots: is empty"},
      {scenario(R"("speed": 3, )" + std::string(two_robots)), "speed"},
      {R"({"map": "small.map", "radius": -1, )" + std::string(two_robots) + "}", "radius: -1 is not allowed"},
      {R"({"map": "small.map", "radius": "NaN", )" + std::string(two_robots) + "}",
       "fleet.json:1: radius: expected a number, found a text"},
      {scenario(R"("max_speed": 0, )" + std::string(two_robots)), "max_speed: 0 is not allowed"},
      {scenario(R"("max_acceleration": -2, )" + std::string(two_robots)),
       "max_acceleration: -2 is not allowed"},
      {scenario(R"("goal_tolerance": 0, )" + std::string(two_robots)), "goal_tolerance: 0 is not allowed"},
      {scenario(R"("robots": [{"start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}}])"), "robots[0].name"},
      {scenario(R"("robots": [{"name": "a b", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}}])"),
       "robots[0].name"},
      {scenario(R"("robots": [{"name": "a", "goal": {"x": 5, "y": 1}}])"), "robots[0].start: is missing"},
      {scenario(R"("robots": [{"name": "a", "start": {"x": 1, "y": 1}}])"), "robots[0].goal: is missing"},
      {scenario(R"("robots": [{"name": "a", "start": {"x": "NaN", "y": 1}, "goal": {"x": 5, "y": 1}}])"),
       "fleet.json:1: robots[0].start.x: expected a number, found a text"},
      {scenario(R"("robots": [{"name": "a", "start": {"x": 3, "y": 2}, "goal": {"x": 5, "y": 1}}])"),
       "robots[0].start: (3, 2) is inside of an obstacle"},
      {scenario(R"("robots": [{"name": "a", "start": {"x": 1, "y": 1}, "goal": {"x": 9, "y": 1}}])"),
       "robots[0].goal: (9, 1) is outside of the map"},
      {scenario(
           R"("robots": [{"name": "a", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}, "radius": -1}])"),
       "robots[0].radius: -1 is not allowed"},
      {scenario(R"("robots": [{"name": "a", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}},
                              {"name": "a", "start": {"x": 1, "y": 3}, "goal": {"x": 5, "y": 3}}])"),
       "robots[1].name: \"a\" is also the name of another robot"},
      {scenario(R"("robots": [{"name": "a", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}},
                              {"name": "b", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 3}}])"),
       "robots[1].start: b and a would overlap"},
      {scenario(R"("robots": [{"name": "a", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}},
                              {"name": "b", "start": {"x": 1, "y": 3}, "goal": {"x": 5, "y": 1.5}}])"),
       "robots[1].goal: b and a would overlap"},
      {scenario(R"("kinematics": "car", )" + std::string(two_robots)),
       "kinematics: \"car\" is unknown, expected holonomic or differential"},
      {scenario(R"("max_angular_speed": 0, )" + std::string(two_robots)),
       "max_angular_speed: 0 is not allowed"},
      {scenario(R"("goal_yaw_tolerance": -1, )" + std::string(two_robots)),
       "goal_yaw_tolerance: -1 is not allowed"},
      {scenario(
           R"("robots": [{"name": "a", "start": {"x": 1, "y": 1, "yaw": 1}, "goal": {"x": 5, "y": 1}}])"),
       "robots[0].start.yaw: a is holonomic, only a differential robot has that"},
      {scenario(R"("kinematics": "differential", "robots": [{"name": "a", "start": {"x": 1, "y": 1},
                   "goal": {"x": 5, "y": 1}, "max_angular_acceleration": 0}])"),
       "robots[0].max_angular_acceleration: 0 is not allowed"},
      {scenario(R"("kinematics": "differential", "max_angular_acceleration": 0.01, )" +
                std::string(two_robots)),
       "robots[0].max_angular_acceleration: 0.01 takes longer than 100 s to come to rest from 40"},
      {scenario(R"("kinematics": "differential", "robots": [{"name": "a", "start": {"x": 1, "y": 1},
                   "goal": {"x": 5, "y": 1, "yaw": 1e30}}])"),
       "robots[0].goal.yaw: 1e+30 is not allowed, expected radians from -6.283 to 6.283"},
      {scenario(
           R"("kinematics": "differential", "robots": [{"name": "a", "start": {"x": 1, "y": 1, "yaw": 90},
                   "goal": {"x": 5, "y": 1}}])"),
       "robots[0].start.yaw: 90 is not allowed, expected radians from -6.283 to 6.283 (90 degrees are "
       "1.571)"},
      {scenario(R"("kinematics": "differential", "goal_yaw_tolerance": 5, )" + std::string(two_robots)),
       "goal_yaw_tolerance: 5 is more than half a turn, expected radians, at most 3.142"},
      {scenario(R"("max_angular_speed": 1, )" + std::string(two_robots)),
       "max_angular_speed: all robots are holonomic, only differential robots have that"},
      {scenario(R"("goal_yaw_tolerance": 0.1, )" + std::string(two_robots)),
       "goal_yaw_tolerance: all robots are holonomic"},
      {scenario(R"("robots": [{"name": "--help", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}}])"),
       "robots[0].name: \"--help\" is not a name, expected 1 to 64 printable characters"},
      {scenario(R"("robots": [{"name": "-1", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}}])"),
       "robots[0].name: \"-1\" is not a name"},
      {scenario(R"("robots": [{"name": "a\nb", "start": {"x": 1, "y": 1}, "goal": {"x": 5, "y": 1}}])"),
       "robots[0].name: \"a?b\" is not a name"},
      {scenario(R"("robots": [{"name": "a", "start": {"x": 1, "y": 0.2}, "goal": {"x": 5, "y": 1},
                   "radius": 0.45018750000000001}])"),
       "robots[0].start: (1, 0.2) is inside of an obstacle or too near to one: clearance 0.2, radius "
       "0.4502"},
      {"{\"map\": ", "fleet.json:1: map: "},
      {"[1, 2]", "fleet.json:1: expected {\"map\": ..."},
      {"", "fleet.json: is empty, expected a scenario"}};
  for (const auto& [json, expected] : cases) {
    const std::string error = error_of(json);
    EXPECT_NE(error.find(expected), std::string::npos)
        << json << "\nsaid: " << error << "\nexpected: " << expected;
  }
}

TEST(ScenarioFile, JsonIsReadStrictly) {
  const std::string start = "{\n\"map\": \"small.map\",\n\"robots\": [\n{\"name\": \"a\", ";
  const std::vector<std::array<std::string, 2>> cases{
      {"{\n\"radius\": \"0.5\"}", "fleet.json:2: radius: expected a number, found a text"},
      {"{\"seed\": \"7\"}", "fleet.json:1: seed: expected a whole number from 0 to 4294967295"},
      {"{\"seed\": 1.5}", "seed: expected a whole number from 0 to 4294967295, found 1.5"},
      {"{\"seed\": -1}", "seed: expected a whole number"},
      {"{\"seed\": 4294967296}", "seed: expected a whole number"},
      {"{\"radius\": true}", "radius: expected a number, found true"},
      {"{\"radius\": null}", "radius: expected a number, found null"},
      {"{\"radius\": NaN}", "fleet.json:1: radius: "},
      {"{\"radius\": 1e999}", "fleet.json:1: radius: "},
      {"{\"radius\": 01}", "fleet.json:1: radius: "},
      {"{\"radius\": .5}", "fleet.json:1: radius: "},
      {"{\"radius\": 1,\n}", "fleet.json:2: radius: a comma before }"},
      {"{\"robots\": [\n{},\n]}", "fleet.json:3: robots[1]: a comma before ]"},
      {"{\"radius\": 1,\n\"radius\": 1}", "fleet.json:2: radius: is given twice"},
      {"{\"max_speed\": 1, \"maxSpeed\": 1}", "max_speed: is given twice"},
      {"{\"radius\": 1 // of all\n}", "fleet.json:1: radius: "},
      {"{'radius': 1}", "fleet.json:1: "},
      {"{radius: 1}", "fleet.json:1: "},
      {"{\"radius\": 1} {}", "fleet.json:1: "},
      {std::string("{\"radius\": 1}\0{}", 16), "fleet.json:1: a zero byte"},
      {"{\"raduis\": 1}",
       "\"raduis\" is not a field (did you mean radius?), expected one of map, radius, max_speed"},
      {"{\"map\": 5}", "map: expected a text in quotes, found 5"},
      {"{\"map\": \"\xff\"}", "fleet.json:1: map: "},
      {"{\"robots\": {}}", "robots: expected a list [...], found an object"},
      {"{\"robots\": [[]]}", "robots[0]: expected {\"name\": ..., \"start\": ..., \"goal\": ..."},
      {start + "\"start\": [20, 20]}]}",
       "fleet.json:4: robots[0].start: expected {\"x\": ..., \"y\": ..., \"yaw\": ...}, found a list"},
      {start + "\"start\": {\"x\": 1,\n\"y\": \"12\"}}]}",
       "fleet.json:5: robots[0].start.y: expected a number, found a text"},
      {start + "\"start\": {\"x\": 1, \"z\": 1}}]}",
       "robots[0].start: \"z\" is not a field, expected one of x, y"},
      {std::string(1'000'000, '['), "fleet.json:1: "},
      {"{\"robots\": " + std::string(1'000'000, '['), "fleet.json:1: robots[0]: "}};
  for (const auto& [json, expected] : cases) {
    const std::string error = error_of(json);
    EXPECT_NE(error.find(expected), std::string::npos)
        << json.substr(0, 200) << "\nsaid: " << error << "\nexpected: " << expected;
  }
}

TEST(ScenarioFile, AByteOrderMarkIsSkippedAndUtf16IsRefused) {
  const TemporaryFolder folder;
  const std::string mark = "\xef\xbb\xbf";
  folder.write("small.map", mark + small_map);
  const std::string json = scenario(two_robots);
  EXPECT_EQ(read_scenario(folder.write("a.json", mark + json), {}).robots.size(), 2u);
  const std::string scen = "version 1\r\n0\tsmall.map\t6\t4\t0\t0\t5\t3\t0\r\n";
  EXPECT_EQ(read_scenario(folder.write("a.scen", mark + scen), {.radius = 0.5}).robots.size(), 1u);
  EXPECT_EQ(read_scenario(folder.write("A.SCEN", scen), {.radius = 0.5}).robots.size(), 1u);
  for (const std::string& begin : {std::string("\xff\xfe{\0", 4), std::string("\xfe\xff\0{", 4),
                                   std::string("{\0\n\0", 4), std::string("\0{\0\n", 4)}) {
    const std::string error = error_of(begin);
    EXPECT_NE(error.find("fleet.json:1: is UTF-16, UTF-32 or not text, expected UTF-8"), std::string::npos)
        << error;
  }
}

TEST(ScenarioFile, MoreRobotsThanTheFileHoldsAreAnError) {
  EXPECT_NE(error_of(scenario(two_robots), small_map, {.robots = 3}).find("robots: 3 were asked for"),
            std::string::npos);
}

TEST(ScenarioFile, MoreRobotsThanAFleetMayHaveAreAnError) {
  std::string robots = R"("robots": [)";
  for (std::size_t k = 0; k <= most_robots; ++k)
    robots += (k == 0 ? "" : ",") +
              std::string(R"({"name": "", "start": {"x": 1, "y": 1}, "goal": {"x": 1, "y": 1}})");
  const std::string many = scenario(robots + "]");
  EXPECT_NE(error_of(many).find("fleet.json: robots: 4097, expected at most 4096"), std::string::npos)
      << error_of(many);
  const std::string of_some = error_of(many, small_map, {.robots = 4096});
  EXPECT_NE(of_some.find("robots[0].name: \"\" is not a name, expected"), std::string::npos) << of_some;
}

TEST(ScenarioFile, AFieldOfAllRobotsIsNamedAsInTheFileAlsoIfEachRobotHasItsOwn) {
  const std::string robots =
      R"("map": "small.map", )" +
      std::string(
          R"("robots": [{"name": "a", "radius": 0.4, "max_speed": 1, "start": {"x": 1, "y": 1}, "goal": {"x": 1, "y": 1}}]})");
  for (const char* field : {"radius", "max_speed", "max_acceleration", "goal_tolerance"}) {
    const std::string error = error_of("{\"" + std::string(field) + "\": -1, " + robots);
    EXPECT_NE(error.find("fleet.json: " + std::string(field) + ": -1"), std::string::npos) << error;
  }
  const std::string slow = error_of(R"({"max_acceleration": 0.001, )" + robots);
  EXPECT_NE(slow.find("fleet.json: max_acceleration: 0.001 takes a longer"), std::string::npos) << slow;
}

TEST(ScenarioFile, AMistakeInAScenFileNamesFileAndLine) {
  const TemporaryFolder folder;
  folder.write("small.map", small_map);
  const auto error = [&](const std::string& content) -> std::string {
    try {
      read_scenario(folder.write("fleet.scen", content), {.radius = 0.5});
    } catch (const InputError& problem) {
      return problem.what();
    }
    return {};
  };
  EXPECT_NE(error("0 small.map\n").find("fleet.scen:1: expected \"version 1\""), std::string::npos);
  EXPECT_NE(error("version 1\n0\tsmall.map\t6\t4\t0\tx\n").find("fleet.scen:2: expected bucket"),
            std::string::npos);
  EXPECT_NE(error("version 1\n0\tsmall.map\t7\t4\t0\t0\t5\t3\t0\n").find("map: is 6 x 4 cells"),
            std::string::npos);
  EXPECT_NE(error("version 1\n").find("map: is missing"), std::string::npos);
}

TEST(ScenarioFile, TheMapMayLieElsewhere) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "maps");
  const auto map = folder.write("maps/small.map", small_map);
  const auto scen = folder.write("fleet.scen", "version 1\n0\tsmall.map\t6\t4\t0\t0\t5\t3\t0\n");
  const auto json = folder.write("fleet.json", scenario(two_robots));
  const auto without = folder.write("none.json", std::string("{\"radius\": 0.5, ") + two_robots + "}");
  for (const auto& file : {scen, json, without}) {
    const Scenario read = read_scenario(file, {.radius = 0.5, .map = map.string()});
    EXPECT_EQ(read.map.width, 6) << file;
    EXPECT_EQ(read.map_file, map.string()) << file;
  }
  for (const auto& file : {scen, json}) {
    try {
      read_scenario(file, {.radius = 0.5});
      ADD_FAILURE() << file;
    } catch (const InputError& problem) {
      EXPECT_EQ(problem.what(), file.string() + ": map: there is no " +
                                    (folder.path() / "small.map").string() +
                                    " (--map FILE names a map that lies elsewhere)");
    }
  }
}

TEST(ScenarioFile, AWrittenScenarioIsReadBack) {
  const TemporaryFolder folder;
  folder.write("small.map", small_map);
  const Scenario before = read_scenario(folder.write("fleet.json", scenario(two_robots)), {});
  write_scenario(folder.path() / "again.json", before);
  const Scenario after = read_scenario(folder.path() / "again.json", {});
  ASSERT_EQ(after.robots.size(), before.robots.size());
  EXPECT_EQ(after.map, before.map);
  for (std::size_t i = 0; i < after.robots.size(); ++i) {
    EXPECT_EQ(after.robots[i].name, before.robots[i].name);
    EXPECT_EQ(after.robots[i].start, before.robots[i].start);
    EXPECT_EQ(after.robots[i].goal, before.robots[i].goal);
    EXPECT_EQ(after.robots[i].radius, before.robots[i].radius);
  }
}

}  // namespace
}  // namespace coppice
