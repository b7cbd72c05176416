#include "motion/differential_drive.h"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "motion/driver.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

constexpr double pi = std::numbers::pi;
/// About a TurtleBot 4.
const Limits turtlebot{
    .max_speed = 0.5, .max_acceleration = 1, .max_angular_speed = 1.9, .max_angular_acceleration = 4};

TEST(DifferentialDrive, ARobotTurnsOnTheSpotBeforeItDrivesToTheSide) {
  const ClearanceField field(test::open_map(20, 20));
  Driver body({5, 5}, 0, 0.22, turtlebot, control_period, 0);
  while (body.yaw() < pi / 2 - 0.4 && body.time() < 10) {
    EXPECT_EQ(body.position(), Point2(5, 5)) << body.time();
    body.follow({0, 0.5}, {}, field);
    body.advance();
  }
  EXPECT_NEAR(body.time(), time_to_turn(pi / 2 - 0.4, turtlebot), 0.3);
  while (body.position().y() < 9 && body.time() < 30) {
    body.follow({0, 0.5}, {}, field);
    body.advance();
  }
  EXPECT_NEAR(body.yaw(), pi / 2, 1e-6);
  EXPECT_NEAR(body.position().x(), 5, 0.05);
  EXPECT_NEAR(body.velocity().norm(), 0.5, 1e-9);
}

TEST(DifferentialDrive, ARobotComesToRestAtTheYawToWhichItTurns) {
  for (const double yaw : {0.01, -0.3, 1.0, 3.0, -3.1}) {
    Driver body({5, 5}, 0, 0.22, turtlebot, control_period, 0.2);
    int periods = 0;
    do {
      body.turn_to(yaw);
      body.advance();
      ++periods;
    } while (body.turns_on_the_spot() && periods < 1000);
    EXPECT_NEAR(wrapped(body.yaw() - yaw), 0, 1e-6) << yaw;
    EXPECT_FALSE(body.turns_on_the_spot()) << yaw;
    EXPECT_LT(periods * control_period, time_to_turn(wrapped(yaw - 0.2), turtlebot) + 0.6) << yaw;
    EXPECT_EQ(body.position(), Point2(5, 5));
  }
}

TEST(DifferentialDrive, ARobotThatBrakesInACurveComesToRestWhereItsPromiseSays) {
  const ClearanceField field(test::open_map(40, 40));
  const Limits limits{
      .max_speed = 3, .max_acceleration = 4, .max_angular_speed = 2, .max_angular_acceleration = 3};
  Driver body({20, 20}, 0, 0.5, limits, control_period, 0);
  for (int k = 0; k < 60; ++k) {  // in a circle
    body.follow(3 * Point2(std::cos(body.yaw() + 0.3), std::sin(body.yaw() + 0.3)), {}, field);
    body.advance();
  }
  ASSERT_GT(body.velocity().norm(), 1);
  ASSERT_GT(body.angular_velocity(), 0.5);
  const Promise promise = body.promise();
  const Point2 straight =
      promise.position_at_turn() + 2 * promise.next_velocity.norm() * promise.next_velocity / 4;
  const Point2 rest = rest_after(promise, limits, control_period);
  while (!body.stands()) body.advance();
  EXPECT_LT((body.position() - rest).norm(), 1e-9);
  EXPECT_GT((body.position() - straight).norm(), 0.05);  // it does not brake in a straight line
}

// No curve is free there: the robot must head exactly along the corridor before it drives.
TEST(DifferentialDrive, ARobotTurnsOnTheSpotInACorridorWithoutSlack) {
  const ClearanceField field(test::open_map(60, 2));
  for (const double yaw : {0.001, -0.1, 0.3, 2.0}) {
    Driver body({5, 1}, 0, 1, turtlebot, control_period, yaw);
    while (body.position().x() < 6 && body.time() < 20) {
      body.follow({0.5, 0}, {}, field);
      body.advance();
    }
    EXPECT_LT(body.time(), 6) << yaw;
    EXPECT_NEAR(body.position().y(), 1, 1e-6) << yaw;
  }
}

TEST(DifferentialDrive, TheChordIsCloseToTheArc) {
  const double sideways = sideways_acceleration(turtlebot);
  const double speed = sideways / turtlebot.max_angular_speed;
  const double radius = speed / turtlebot.max_angular_speed;
  const double half = turtlebot.max_angular_speed * control_period / 2;
  EXPECT_LE(radius * (1 - std::cos(half)), off_the_chord(turtlebot, control_period));
  EXPECT_LT(off_the_chord(turtlebot, control_period), 0.001);
}

}  // namespace
}  // namespace coppice
