#include "motion/body/differential_drive.h"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "motion/body/driver.h"
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
    body.take(body.following({0, 0.5}, {}, field).next);
    body.advance();
  }
  EXPECT_NEAR(body.time(), time_to_turn(pi / 2 - 0.4, turtlebot), 0.3);
  while (body.position().y() < 9 && body.time() < 30) {
    body.take(body.following({0, 0.5}, {}, field).next);
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
      body.take(body.facing(yaw));
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
    const Point2 wanted = 3 * Point2(std::cos(body.yaw() + 0.3), std::sin(body.yaw() + 0.3));
    body.take(body.following(wanted, {}, field).next);
    body.advance();
  }
  ASSERT_GT(body.velocity().norm(), 1);
  ASSERT_GT(body.angular_velocity(), 0.5);
  const Promise promise = body.promise();
  const Point2 straight =
      promise.position_at_decision() + 2 * promise.next_velocity.norm() * promise.next_velocity / 4;
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
      body.take(body.following({0.5, 0}, {}, field).next);
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

/// The largest distance of an arc from its chord among many twists that a robot with such limits can take.
double furthest_off_a_chord(const Limits& limits) {
  const double sideways = sideways_acceleration(limits);
  double furthest = 0;
  for (int i = 0; i <= 40; ++i) {
    const double rate = limits.max_angular_speed * i / 40;
    for (int k = 0; k <= 40; ++k) {
      const double speed = std::min(limits.max_speed, sideways / std::max(rate, 1e-9)) * k / 40;
      for (const double turning : {rate, limits.max_angular_speed * k / 40, limits.max_angular_speed}) {
        for (const double wanted : {0.0, speed, limits.max_speed}) {
          const Twist next = feasible_twist(wanted, turning, {{speed, 0}, rate}, 0, limits, control_period);
          const double turned = std::abs(next.angular_velocity) * control_period;
          furthest = std::max(furthest, next.velocity.norm() * control_period / 2 * std::tan(turned / 4));
        }
      }
    }
  }
  return furthest;
}

// At 60 rad/s the arcs were further off than the robots reckoned with, by a quarter.
TEST(DifferentialDrive, NoArcIsFurtherOffItsChordThanRobotsReckonWith) {
  for (const double rate : {0.1, 0.5, 1.9, 6.0, 15.0, 30.0, 45.0, 60.0, 62.0}) {
    const Limits limits{.max_speed = 20 / rate,
                        .max_acceleration = 4,
                        .max_angular_speed = rate,
                        .max_angular_acceleration = rate};
    const double furthest = furthest_off_a_chord(limits);
    EXPECT_LE(furthest, off_the_chord(limits, control_period) + 1e-12) << rate;
    EXPECT_GE(1.01 * furthest, off_the_chord(limits, control_period)) << rate;
    Limits slow = limits;
    slow.max_speed = 1 / rate;
    EXPECT_LE(furthest_off_a_chord(slow), off_the_chord(slow, control_period) + 1e-12) << rate;
  }
}

}  // namespace
}  // namespace coppice
