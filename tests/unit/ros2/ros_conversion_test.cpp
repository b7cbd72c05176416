// Tests of names, frames and values of ROS 2.
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/clearance_field.h"
#include "dds/discovery.h"
#include "ros2/conversion.h"
#include "ros2/names.h"
#include "runtime/process_options.h"

namespace coppice {
namespace {

using std::numbers::pi;

TEST(RosNames, ValidRosNamesStayAndOthersAreReplaced) {
  EXPECT_EQ(ros_name("r1"), "r1");
  EXPECT_EQ(ros_name("Robot_7"), "Robot_7");
  EXPECT_EQ(ros_name("r-1"), "r_1");
  EXPECT_EQ(ros_name("7"), "_7");
  EXPECT_EQ(ros_name("a b/c"), "a_b_c");
  EXPECT_EQ(ros_name("\xc3\xa4"), "__");  // bytes, not characters
  EXPECT_EQ(ros_topic(RosNames{}, "r-1", "odom"), "rt/r_1/odom");
  EXPECT_EQ(ros_topic("map"), "rt/map");
  EXPECT_EQ(filled(RosNames{}.base_frame, "7"), "_7/base_link");
}

TEST(RosNames, ARobotHasTheNamesThatTheUserGives) {
  EXPECT_EQ(ros_topic({.robot_namespace = "site/{}/{}"}, "r-1", "odom"), "rt/site/r_1/r_1/odom");
  EXPECT_EQ(ros_topic({.robot_namespace = ""}, "r1", "odom"), "rt/odom");
  EXPECT_EQ(filled("base_link", "r1"), "base_link");
  EXPECT_THROW(check_ros_names({.robot_namespace = "all"}, std::vector<RobotName>{"r1", "r2"}),
               std::runtime_error);
  EXPECT_NO_THROW(check_ros_names({.robot_namespace = "all"}, std::vector<RobotName>{"r1"}));
}

TEST(RosNames, TwoRobotsWithTheSameRosNameAreRefused) {
  EXPECT_NO_THROW(check_ros_names({}, std::vector<RobotName>{"r1", "r-1", "r2"}));
  try {
    check_ros_names({}, std::vector<RobotName>{"r-1", "r2", "r.1"});
    FAIL();
  } catch (const std::runtime_error& problem) {
    EXPECT_STREQ(problem.what(), "robots r-1 and r.1 would both be \"r_1\" in ROS: rename one of them");
  }
}

TEST(RosOptions, OptionsThatExcludeRosAreRefused) {
  const RosOptions on{.on = true};
  EXPECT_NO_THROW(check_ros({}, "static", "keys"));
  EXPECT_NO_THROW(check_ros(on, "", ""));
  EXPECT_NO_THROW(check_ros(on, "10.0.0.1:11811", ""));
  EXPECT_THROW(check_ros(on, "static", ""), std::runtime_error);
  EXPECT_THROW(check_ros(on, "", "keys"), std::runtime_error);
}

TEST(RosOptions, TheDefaultDomainIsTheDomainOfRos) {
  unsetenv("ROS_DOMAIN_ID");
  EXPECT_EQ(usual_ros_domain(), 0);
  setenv("ROS_DOMAIN_ID", "42", 1);
  EXPECT_EQ(usual_ros_domain(), 42);
  for (const char* bad : {"233", "-1", "4x", " 4"}) {
    setenv("ROS_DOMAIN_ID", bad, 1);
    EXPECT_THROW(usual_ros_domain(), std::runtime_error) << bad;
  }
  unsetenv("ROS_DOMAIN_ID");
}

OccupancyMap map_with_a_corner() {
  OccupancyMap map{.width = 4, .height = 3, .resolution = 0.5, .origin = {1, 2}};
  map.blocked.assign(12, 0);
  map.blocked[1] = 1;  // second cell of the first row: x 1.5..2, y 2..2.5
  return map;
}

TEST(RosConversion, TheFlippedMapIsFreeWhereTheMapIs) {
  const OccupancyMap map = map_with_a_corner();
  const OccupancyMap up = with_y_up(map);
  EXPECT_EQ(up.y_axis, YAxis::up);
  EXPECT_EQ(up.origin, Point2(1, -3.5));
  EXPECT_TRUE(up.is_blocked(1, 2));
  const ClearanceField here(map);
  const ClearanceField there(up);
  for (double x = 0.9; x < 3.2; x += 0.13) {
    for (double y = 1.9; y < 3.7; y += 0.17)
      EXPECT_NEAR(here.clearance({x, y}), there.clearance(turned({x, y}, map.y_axis)), 1e-12);
  }
  EXPECT_EQ(with_y_up(up), up);
  EXPECT_EQ(turned({3, 4}, YAxis::up), Point2(3, 4));
}

TEST(RosConversion, TheYawFollowsTheVelocityAndStaysWhileTheRobotStands) {
  Heading heading;
  EXPECT_EQ(heading.facing({0, 0}), 0);
  EXPECT_DOUBLE_EQ(heading.facing({0, 2}), pi / 2);
  EXPECT_DOUBLE_EQ(heading.facing({0, 0}), pi / 2);
  EXPECT_DOUBLE_EQ(heading.facing({-1, -1}), -3 * pi / 4);
}

TEST(RosConversion, VectorsAreConvertedIntoTheRobotsFrameAndBack) {
  EXPECT_NEAR((into_robot({0, 2}, pi / 2) - Point2(2, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((into_robot({1, 0}, pi / 2) - Point2(0, -1)).norm(), 0, 1e-12);  // to its right
  EXPECT_NEAR((out_of_robot(into_robot({3, -4}, 0.7), 0.7) - Point2(3, -4)).norm(), 0, 1e-12);
}

TEST(RosConversion, TheYawOfAQuaternionIgnoresItsTilt) {
  EXPECT_NEAR(yaw_of(0, 0, std::sin(0.4), std::cos(0.4)), 0.8, 1e-12);
  EXPECT_NEAR(yaw_of(0, 0, std::sin(1.5), std::cos(1.5)), 3.0, 1e-12);
  // Yaw 0.8, then a roll of 0.3: q = qz * qx.
  const double s = std::sin(0.4), c = std::cos(0.4), sr = std::sin(0.15), cr = std::cos(0.15);
  EXPECT_NEAR(yaw_of(c * sr, s * sr, s * cr, c * cr), 0.8, 1e-12);
}

TEST(RosConversion, InvalidMessagesAreRefused) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(problem_with(RosGoal{"r", "map", {1, 2}}, "map"));
  EXPECT_FALSE(problem_with(RosGoal{"r", "", {1, 2}}, "map"));
  EXPECT_TRUE(problem_with(RosGoal{"r", "odom", {1, 2}}, "map"));
  EXPECT_TRUE(problem_with(RosGoal{"r", "map", {1, nan}}, "map"));
  EXPECT_TRUE(problem_with(RosGoal{"r", "map", {-infinity, 0}}, "map"));
  EXPECT_TRUE(problem_with(RosGoal{"r", "map", {1, 2}, nan}, "map"));
  EXPECT_TRUE(problem_with(RosGoal{"r", "map", {1, 2}}, "site"));
  const RosOdometry fine{.frame = "map", .pose = {{1, 2}, 3}, .twist = {{1, 0}, 0}};
  EXPECT_FALSE(problem_with(fine, "map"));
  const auto with = [&](auto&& change) {
    RosOdometry other = fine;
    change(other);
    return problem_with(other, "map");
  };
  EXPECT_TRUE(with([](RosOdometry& o) { o.frame = "r/odom"; }));
  EXPECT_TRUE(with([](RosOdometry& o) { o.frame = ""; }));
  EXPECT_TRUE(with([](RosOdometry& o) { o.pose.position.x() = nan; }));
  EXPECT_TRUE(with([](RosOdometry& o) { o.pose.yaw = nan; }));
  EXPECT_TRUE(with([](RosOdometry& o) { o.twist.linear.y() = infinity; }));
  EXPECT_TRUE(with([](RosOdometry& o) { o.twist.angular = nan; }));
}

}  // namespace
}  // namespace coppice
