// Tests of how fast the reference of a robot may drive and turn.
#include "robot_agent/process/reference_limits.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

/// A usual robot, with the usual tolerance: a TurtleBot 4.
constexpr Follower turtlebot{.limits = {.max_speed = 0.3,
                                        .max_acceleration = 0.9,
                                        .max_angular_speed = 1.9,
                                        .max_angular_acceleration = 4},
                             .radius = 0.22,
                             .tolerance = 0.075};

TEST(ReferenceLimits, TheReferenceOfAUsualRobotUsesItsShareOfTheSpeed) {
  const Limits limits = reference_limits(turtlebot, 1);
  EXPECT_DOUBLE_EQ(limits.max_speed, 0.9 * 0.3);
  EXPECT_DOUBLE_EQ(limits.max_angular_speed, 0.9 * 1.9);
  EXPECT_DOUBLE_EQ(limits.max_acceleration, 0.8 * 0.9);
  EXPECT_DOUBLE_EQ(limits.max_angular_acceleration, 0.8 * 4);
}

TEST(ReferenceLimits, TheReferenceOfAHolonomicRobotIsNotSlowerBecauseItsWheelsAreClose) {
  Follower robot = turtlebot;
  robot.limits.max_angular_speed = robot.limits.max_angular_acceleration = 0;
  robot.radius = 0.001;
  EXPECT_DOUBLE_EQ(reference_limits(robot, 1).max_speed, 0.9 * 0.3);
}

/// Once its reference drove at 13 m/s, and a wheel that slips turned it faster than it could steer.
TEST(ReferenceLimits, TheReferenceOfAFastRobotThatTurnsSlowlyIsSlower) {
  const Follower robot{.limits = {.max_speed = 14.9,
                                  .max_acceleration = 246,
                                  .max_angular_speed = 0.87,
                                  .max_angular_acceleration = 5.8},
                       .radius = 0.3,
                       .tolerance = 0.96};
  const double speed = reference_limits(robot, 1).max_speed;
  const double turns_at = speed / (wheels_at * robot.radius) * unequal_wheels(Following{}.slip);
  EXPECT_LE(turns_at, robot.limits.max_angular_speed / 4 * (1 + 1e-9));
  EXPECT_GT(speed, 1);
  EXPECT_DOUBLE_EQ(largest_reference_speed(robot, {}), speed);
  EXPECT_GT(largest_reference_speed(robot, {.slip = 0.02}), 2 * speed);
}

TEST(ReferenceLimits, MoreToleranceAllowsMoreSpeed) {
  Follower robot = turtlebot;
  double before = 0;
  for (const double tolerance : {0.01, 0.02, 0.04, 0.06}) {
    robot.tolerance = tolerance;
    const double speed = reference_limits(robot, 1).max_speed;
    EXPECT_GT(speed, before);
    before = speed;
  }
}

TEST(ReferenceLimits, AReferenceTurnsAsFastAsItsRobotComesToTurn) {
  Follower robot = turtlebot;
  robot.limits.max_angular_acceleration = 0.05;
  const Limits limits = reference_limits(robot, 1);
  EXPECT_DOUBLE_EQ(limits.max_angular_speed, 10 * limits.max_angular_acceleration);
}

TEST(ReferenceLimits, TheLimitsOfAFasterClockAreTheSameOnTheWall) {
  Follower robot = turtlebot;
  robot.tolerance = 0.04;
  const Limits by_the_wall = reference_limits(robot, 1);
  constexpr double scale = 4;
  robot.limits = {.max_speed = robot.limits.max_speed / scale,
                  .max_acceleration = robot.limits.max_acceleration / scale / scale,
                  .max_angular_speed = robot.limits.max_angular_speed / scale,
                  .max_angular_acceleration = robot.limits.max_angular_acceleration / scale / scale};
  const Limits limits = reference_limits(robot, scale);
  EXPECT_NEAR(limits.max_speed * scale, by_the_wall.max_speed, 1e-9);
  EXPECT_NEAR(limits.max_acceleration * scale * scale, by_the_wall.max_acceleration, 1e-9);
}

TEST(ReferenceLimits, ARobotWhoseToleranceIsNotKnownHasAReference) {
  Follower robot = turtlebot;
  robot.tolerance = 0;
  EXPECT_DOUBLE_EQ(reference_limits(robot, 1).max_speed, 0.9 * 0.3);
}

}  // namespace
}  // namespace coppice
