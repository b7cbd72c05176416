// Tests of simulated robots that follow badly.
#include "simulation/following_robot.h"

#include <cmath>

#include <gtest/gtest.h>

namespace coppice {
namespace {

RobotTask turtle() {
  return {.name = "r1",
          .start = {1, 2},
          .radius = 0.2,
          .max_speed = 0.5,
          .max_acceleration = 1,
          .max_angular_speed = 2,
          .max_angular_acceleration = 4,
          .start_yaw = 0};
}

FollowingRobot driven(const RobotTask& task, const DriveFaults& faults, const DriveCommand& command,
                      double seconds) {
  FollowingRobot robot(task, faults, 0, Random(1));
  while (robot.time() < seconds - 1e-9) robot.advance(command, control_period);
  return robot;
}

TEST(FollowingRobot, ItComesCloserToItsCommandWithTheTimeConstantOfItsLag) {
  RobotTask quick = turtle();
  quick.max_acceleration = 100;  // the lag alone holds it up
  const DriveCommand ahead{.linear = {0.4, 0}};
  const double after_lag = driven(quick, {.lag = 0.2}, ahead, 0.2).at().velocity.norm();
  EXPECT_NEAR(after_lag, 0.4 * (1 - std::exp(-1)), 1e-9);
  EXPECT_NEAR(driven(quick, {.odometry_noise = 0.01}, ahead, 0.05).at().velocity.norm(), 0.4, 1e-9);
}

TEST(FollowingRobot, ItKeepsItsLimits) {
  const FollowingRobot robot = driven(turtle(), {.slip = 0.01}, {.linear = {9, 0}, .angular = 9}, 3);
  EXPECT_LE(robot.at().velocity.norm(), 0.5 + 1e-9);
  EXPECT_LE(robot.at().angular_velocity, 2 + 1e-9);
  const FollowingRobot once = driven(turtle(), {.slip = 0.01}, {.linear = {9, 0}}, 0.05);
  EXPECT_LE(once.at().velocity.norm(), 0.8 * 0.05 + 1e-9);
}

TEST(FollowingRobot, WheelsThatSlipLeadItAsideAndMakeItSlower) {
  const FollowingRobot exact = driven(turtle(), {.lag = 1e-3}, {.linear = {0.4, 0}}, 10);
  const FollowingRobot slips = driven(turtle(), {.slip = 0.1}, {.linear = {0.4, 0}}, 10);
  EXPECT_NEAR(exact.at().position.y(), 2, 1e-9);
  EXPECT_GT(std::abs(slips.at().position.y() - 2), 0.05);
  EXPECT_LT(slips.at().velocity.norm(), 0.4);
  EXPECT_GE(slips.at().velocity.norm(), 0.9 * 0.4);
}

TEST(FollowingRobot, OdometryHasTheNoiseThatWasAskedFor) {
  FollowingRobot robot(turtle(), {.odometry_noise = 0.02}, 0, Random(1));
  Point2 sum = Point2::Zero();
  double squares = 0;
  double yaw_squares = 0;
  constexpr int samples = 20'000;
  for (int k = 0; k < samples; ++k) {
    const OdometrySample seen = robot.odometry(k);
    sum += seen.position - Point2(1, 2);
    squares += (seen.position - Point2(1, 2)).squaredNorm() / 2;
    yaw_squares += seen.yaw * seen.yaw;
  }
  EXPECT_LT(sum.norm() / samples, 0.001);
  EXPECT_NEAR(std::sqrt(squares / samples), 0.02, 0.0005);
  EXPECT_NEAR(std::sqrt(yaw_squares / samples), 0.02, 0.0005);
}

TEST(FollowingRobot, AHolonomicRobotDrivesInAnyDirection) {
  RobotTask holonomic = turtle();
  holonomic.max_angular_speed = holonomic.max_angular_acceleration = 0;
  const FollowingRobot robot = driven(holonomic, {.lag = 0.1}, {.linear = {0, -0.4}}, 5);
  EXPECT_NEAR(robot.at().position.x(), 1, 1e-9);
  EXPECT_LT(robot.at().position.y(), 0.5);
}

}  // namespace
}  // namespace coppice
