#include "files/pose_file.h"

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "tests/support.h"

namespace coppice {
namespace {

/// A hall of 20 m x 10 m with a wall at its right end. Robot b is differential.
Scenario hall() {
  Scenario site;
  site.map = {.width = 20, .height = 10, .blocked = std::vector<std::uint8_t>(200, 0)};
  for (int j = 0; j < 10; ++j) site.map.blocked[static_cast<std::size_t>(20 * j + 19)] = 1;
  site.robots = {{"a", {2, 2}, {2, 2}, 1, 1, 1, 1}, {"b", {2, 6}, {2, 6}, 1, 1, 1, 1}};
  site.robots[1].max_angular_speed = site.robots[1].max_angular_acceleration = 1;
  return site;
}

std::string error_of_poses(const std::string& json) {
  const test::TemporaryFolder folder;
  try {
    read_poses(folder.write("poses.json", json), hall());
  } catch (const InputError& problem) {
    return problem.what();
  }
  return {};
}

constexpr const char* fine =
    R"({"robots": [{"name": "b", "x": 5, "y": 6, "yaw": 1.5}, {"name": "a", "x": 8.25, "y": 3, "yaw": null}]})";

TEST(PoseFile, EachRobotHasAPose) {
  const test::TemporaryFolder folder;
  const auto poses = read_poses(folder.write("poses.json", fine), hall());
  EXPECT_EQ(pose_of(poses, "a")->position, Point2(8.25, 3));
  EXPECT_EQ(pose_of(poses, "b")->yaw, 1.5);
  EXPECT_EQ(pose_of(poses, "c"), nullptr);
}

TEST(PoseFile, WhatIsWrittenIsRead) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "poses.json";
  write_poses(file, std::vector<RobotPose>{{"a", {13.0 / 3, 2}, 7}, {"b", {5, 6}, -0.1}}, hall());
  const auto poses = read_poses(file, hall());
  EXPECT_EQ(pose_of(poses, "a")->position, Point2(13.0 / 3, 2));
  EXPECT_EQ(pose_of(poses, "b")->yaw, -0.1);
}

TEST(PoseFile, MistakesAreNamedWithFileAndRobot) {
  const std::string b = R"({"name": "b", "x": 5, "y": 6, "yaw": 0})";
  const auto with = [&](const std::string& a) { return R"({"robots": [)" + b + ", " + a + "]}"; };
  for (const auto& [json, problem] : std::vector<std::pair<std::string, std::string>>{
           {R"({"robots": [)" + b + "]}",
            "poses.json: a is missing, expected a pose for each robot of the site"},
           {with(R"({"name": "a", "x": 5})"), "poses.json: robots[1].y: is missing"},
           {with(R"({"name": "c", "x": 5, "y": 1})"),
            "poses.json: robots[1].name: c is no robot of this site"},
           {with(b), "robots[1].name: b has a pose already"},
           {with(R"({"name": "a", "x": 5, "y": 4.5})"),
            "robots[1]: a and b would overlap: distance 1.5, sum of their radii 2"},
           {with(R"({"name": "a", "x": 18.5, "y": 3})"),
            "robots[1] (a): (18.5, 3) is inside of an obstacle or too near to one: clearance 0.5, radius 1"},
           {with(R"({"name": "a", "x": -9, "y": 3})"), "robots[1] (a): (-9, 3) is outside of the map"},
           {R"({"robots": [{"name": "b", "x": 5, "y": 6, "yaw": 90}]})",
            "robots[0].yaw: 90 is not allowed, expected radians"},
           {with(R"({"name": "a", "x": 8, "y": 3, "yaw": 1})"), "robots[1].yaw: a is holonomic"},
           {R"({"robots": [{"name": "b", "x": 5, "y": 6}]})",
            "robots[0].yaw: is missing, expected the heading of b"},
           {R"({"robots": [{"name": "a", "x": "5", "y": 6}]})", "robots[0].x: expected a number"},
           {R"({"robots": [{"x": 5, "y": 6}]})", "robots[0].name: is missing"},
           {R"({"robots": [{"name": "a", "z": 6}]})", "poses.json:1"}}) {
    EXPECT_NE(error_of_poses(json).find(problem), std::string::npos)
        << json << "\nsaid: " << error_of_poses(json);
  }
}

// By less than the tolerance, as in a scenario.
TEST(PoseFile, ARobotMayStandALittleTooNearToAWall) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("poses.json", R"({"robots": [{"name": "a", "x": 18.3, "y": 3},
                                                              {"name": "b", "x": 5, "y": 6, "yaw": 0}]})");
  const auto poses = read_poses(file, hall());
  EXPECT_EQ(pose_of(poses, "a")->position, Point2(18.3, 3));
  EXPECT_EQ(
      warnings_of_starts(hall(), poses),
      std::vector<std::string>{"a starts 0.3 m too near to an obstacle, at (18.3, 3): it drives out first"});
  EXPECT_NO_THROW(check_saved_poses(hall(), poses));
}

TEST(PoseFile, ARobotThatIsNewMayNotStartWhereAnotherOneStands) {
  const std::vector<RobotPose> poses{{"a", {2, 7.5}, 0}};
  EXPECT_THROW(check_saved_poses(hall(), poses), InputError);
  EXPECT_NO_THROW(check_saved_poses(hall(), std::vector<RobotPose>{{"a", {8, 7.5}, 0}}));
  EXPECT_NO_THROW(check_saved_poses(hall(), std::vector<RobotPose>{{"gone", {2, 6}, 0}}));
}

TEST(PoseFile, ARobotMayNotHaveStoodInAWall) {
  try {
    check_saved_poses(hall(), std::vector<RobotPose>{{"a", {18.6, 3}, 0}});
    ADD_FAILURE() << "taken";
  } catch (const InputError& problem) {
    EXPECT_STREQ(problem.what(),
                 "where a robot stood at last (a): (18.6, 3) is inside of an obstacle or too near to one: "
                 "clearance 0.4, radius 1: if it is elsewhere, name a file of poses (--start-at)");
  }
}

}  // namespace
}  // namespace coppice
