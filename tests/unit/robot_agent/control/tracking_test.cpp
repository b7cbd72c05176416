// Tests of how a real robot is led to its reference.
#include "robot_agent/control/tracking.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"

namespace coppice {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double period = 0.05;
constexpr Limits turtle{
    .max_speed = 0.5, .max_acceleration = 1, .max_angular_speed = 2, .max_angular_acceleration = 4};
constexpr Rest anywhere{.metres = 1, .radians = 1};

/// A robot that is seen where the test says, while its reference stands in the origin.
struct Seen {
  DriveCommand at(const Point2& position, double yaw, const Rest& rest = anywhere) {
    now += period;
    tracking.see({.at = now, .position = position, .yaw = yaw}, Point2::Zero(), 0);
    return tracking.command({}, turtle, rest, now);
  }
  DriveCommand long_at(const Point2& position, double yaw, const Rest& rest = anywhere) {
    DriveCommand command;
    for (int k = 0; k < 100; ++k) command = at(position, yaw, rest);
    return command;
  }
  Tracking tracking{{}, 0.2, 0.5};
  double now = 0;
};

TEST(Tracking, ARobotWithItsBackToItsReferenceTurnsToOneSide) {
  Seen robot;
  const double first = robot.long_at({0.15, 0}, 0.05).angular;
  ASSERT_GT(std::abs(first), 1);
  for (int k = 0; k < 40; ++k) {
    const double yaw =
        k / 4 % 2 == 0 ? -0.3 : 0.3;  // the shorter way round is now to one side, now to the other
    EXPECT_GT(robot.at({0.15, 0}, yaw).angular * first, 0);
  }
}

TEST(Tracking, ARobotThatTurnsOnTheSpotToItsReferenceTakesTheShorterWayIfItIsMuchShorter) {
  Seen robot;
  const double first = robot.long_at({0.15, 0}, 0.5 - pi).angular;
  const double second = robot.long_at({0.15, 0}, pi - 0.5).angular;
  EXPECT_LT(first * second, 0);
}

TEST(Tracking, TheSpeedOfARobotThatDrivesBackChangesSteadilyWithItsBearing) {
  double before = 0;
  for (double off = 0.6; off >= 0; off -= 0.01) {
    Seen robot;
    const double speed = robot.long_at({-0.15, 0}, off).linear.x();
    EXPECT_GE(speed, before);
    EXPECT_LT(speed, before + 0.01);
    before = speed;
  }
  EXPECT_GT(before, 0.05);
}

TEST(Tracking, ARobotThatRestsDoesNotBeginAtOnceAgain) {
  const Rest rest{.metres = 0.05, .radians = 0.05};
  Seen robot;
  EXPECT_GT(robot.long_at({-0.06, 0}, 0, rest).linear.x(), 0);
  EXPECT_GT(robot.long_at({-0.03, 0}, 0, rest).linear.x(), 0) << "it comes on";
  EXPECT_EQ(robot.long_at({-0.01, 0}, 0, rest).linear.x(), 0);
  EXPECT_EQ(robot.long_at({-0.04, 0}, 0, rest).linear.x(), 0) << "it has settled";
  EXPECT_LT(robot.long_at({-0.01, 0}, 0.06, rest).angular, 0);
  EXPECT_LT(robot.long_at({-0.01, 0}, 0.03, rest).angular, 0) << "it turns on";
  EXPECT_EQ(robot.long_at({-0.01, 0}, 0.01, rest).angular, 0);
  EXPECT_EQ(robot.long_at({-0.01, 0}, 0.04, rest).angular, 0) << "it has settled";
}

TEST(Tracking, TheReferenceWaitsForARobotThatHeadsElsewhereByMoreThanThreeTenthsOfARadian) {
  Seen robot;
  robot.long_at(Point2::Zero(), 0);
  robot.long_at(Point2::Zero(), 0.29);
  EXPECT_TRUE(robot.tracking.keeps_up(robot.now));
  robot.long_at(Point2::Zero(), 0.31);
  EXPECT_FALSE(robot.tracking.keeps_up(robot.now));
  robot.long_at(Point2::Zero(), 0.25);
  EXPECT_FALSE(robot.tracking.keeps_up(robot.now)) << "not before it heads there";
  robot.long_at({0.07, 0}, 0.15);
  EXPECT_TRUE(robot.tracking.keeps_up(robot.now));
  robot.long_at({0.09, 0}, 0);
  EXPECT_TRUE(robot.tracking.keeps_up(robot.now));
  robot.long_at({0.11, 0}, 0);
  EXPECT_FALSE(robot.tracking.keeps_up(robot.now));
  robot.long_at({0.09, 0}, 0);
  EXPECT_FALSE(robot.tracking.keeps_up(robot.now));
}

/// Where the robot stands and heads as it should, with such noise. How often it did not stand still.
int moves_with(const TrackingSettings& settings, double noise, const Rest& rest) {
  Seen robot{.tracking = Tracking(settings, 0.2, 0.5)};
  Random random(1);
  int moves = 0;
  for (int k = 0; k < 4000; ++k) {
    const double aside = random.uniform(-noise, noise);
    const DriveCommand command =
        robot.at({aside, random.uniform(-noise, noise)}, random.uniform(-noise, noise), rest);
    if (!command.linear.isZero(0) || command.angular != 0) ++moves;
  }
  return moves;
}

TEST(Tracking, ARobotThatStandsWaitsUntilItKnowsWhereItIsWithItsNoise) {
  constexpr double noise = 0.1;
  constexpr double deviation = 0.577 * noise;  // of a uniform one
  const Rest rest{.metres = 0.04, .radians = 0.04};
  EXPECT_GT(moves_with({}, noise, rest), 100);
  EXPECT_LT(moves_with({.noise = deviation, .yaw_noise = deviation}, noise, rest), 10);
}

TEST(Tracking, AReferenceThatComesToRestDoesNotSendItsRobotOn) {
  Seen robot;
  robot.long_at(Point2::Zero(), 0);
  const Twist last_of_braking{.velocity = {-0.1, 0}};  // the command is ahead of the reference's braking
  EXPECT_EQ(robot.tracking.command(last_of_braking, turtle, anywhere, robot.now).linear.x(), 0);
}

TEST(Correction, ARobotMakesUpForAnErrorNoFasterThanItsReserveStopsIt) {
  const Correction slow = Tracking::of_position({.max_speed = 10, .max_acceleration = 1});
  EXPECT_DOUBLE_EQ(slow.reserve, 0.2);
  const double speed = slow.speed(2);
  EXPECT_LE(speed * speed / (2 * slow.reserve), 2);
  EXPECT_DOUBLE_EQ(slow.speed(-2), -speed);
  for (const double error : {0.01, 0.1, 1.0, 10.0}) EXPECT_NEAR(slow.error(slow.speed(error)), error, 1e-9);
}

}  // namespace
}  // namespace coppice
