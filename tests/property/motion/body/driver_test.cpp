// Tests of robots that push into each other, hear each other late or not at all, and change their wishes.
// They never touch a robot or a wall, and they keep their promises.
#include "motion/body/driver.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "coppice/planning/random.h"
#include "motion/trajectory/segments.h"

namespace coppice {
namespace {

constexpr double period = 0.05;

OccupancyMap walled_map(Random& random) {
  OccupancyMap map{.width = 60, .height = 60, .blocked = std::vector<std::uint8_t>(3600, 0)};
  for (int k = 0; k < 6; ++k) {
    const std::size_t i = random.index(60);
    const std::size_t j = random.index(60);
    map.blocked[j * 60 + i] = 1;
  }
  return map;
}

Point2 any_velocity(double speed, Random& random) {
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  return random.uniform(0, speed) * Point2(std::cos(angle), std::sin(angle));
}

struct Robot {
  Driver body;
  Point2 wanted = Point2::Zero();
  std::vector<Promise> heard_of;  ///< the last promise heard from each robot
};

std::vector<Robot> place_robots(const ClearanceField& field, Random& random) {
  std::vector<Robot> robots;
  for (int tries = 0; tries < 200 && robots.size() < 8; ++tries) {
    const Point2 p(random.uniform(0, 60), random.uniform(0, 60));
    const double radius = random.uniform(1, 4);
    const double speed = random.uniform(2, 20);
    Limits limits{speed, speed * random.uniform(0.5, 4)};
    if (random.index(2) == 0) {
      limits.max_angular_speed = random.uniform(0.2, 6);
      limits.max_angular_acceleration = limits.max_angular_speed * random.uniform(0.5, 20);
    }
    const bool apart = std::ranges::all_of(robots, [&](const Robot& other) {
      return (other.body.position() - p).norm() > other.body.radius() + radius + 0.01;
    });
    if (apart && field.is_free(p, radius))
      robots.push_back({Driver(p, 0, radius, limits, period, random.uniform(-3, 3)), Point2::Zero(), {}});
  }
  for (Robot& robot : robots) {
    for (const Robot& other : robots) robot.heard_of.push_back(other.body.promise());
  }
  return robots;
}

std::vector<Neighbour> neighbours_of(std::size_t self, const std::vector<Robot>& robots) {
  std::vector<Neighbour> result;
  for (std::size_t k = 0; k < robots.size(); ++k) {
    if (k == self) continue;
    result.push_back({robots[self].heard_of[k], robots[k].body.radius(), robots[k].body.limits(), false});
  }
  return result;
}

/// A robot stays within its limits from one period to the next. A differential robot drives along its
/// heading.
void assert_within_limits(const Driver& before, const Driver& body) {
  const Limits& limits = body.limits();
  const double rounding = 1e-9;
  RC_ASSERT((body.velocity() - before.velocity()).norm() <= limits.max_acceleration * period + rounding);
  RC_ASSERT(body.velocity().norm() <= limits.max_speed + rounding);
  if (!is_differential(limits)) return;
  RC_ASSERT(std::abs(body.angular_velocity()) <= limits.max_angular_speed + rounding);
  RC_ASSERT(std::abs(body.angular_velocity() - before.angular_velocity()) <=
            limits.max_angular_acceleration * period + rounding);
  RC_ASSERT(std::abs(wrapped(before.yaw() + period * before.angular_velocity() - body.yaw())) <= rounding);
  const double chord = body.yaw() + period * body.angular_velocity() / 2;
  const Point2 sideways(-std::sin(chord), std::cos(chord));
  RC_ASSERT(std::abs(sideways.dot(body.velocity())) <= rounding * limits.max_speed);
  RC_ASSERT(body.velocity().dot(Point2(std::cos(chord), std::sin(chord))) >= 0);
}

RC_GTEST_PROP(Driver, NoRobotTouchesAnythingHoweverLittleIsHeard, (std::uint64_t seed)) {
  Random random(seed);
  const ClearanceField field(walled_map(random));
  std::vector<Robot> robots = place_robots(field, random);
  const double loss = random.uniform(0, 0.9);
  const double whim = random.uniform(0.01, 0.3);
  const double idle = random.uniform(0, 0.3);
  for (int step = 0; step < 400; ++step) {
    // All robots decide on what they heard. Then each hears the others or not.
    for (std::size_t k = 0; k < robots.size(); ++k) {
      Driver& body = robots[k].body;
      if (random.uniform() < idle) continue;  // too late to decide, so that it brakes
      if (random.uniform() < whim) robots[k].wanted = any_velocity(1.5 * body.limits().max_speed, random);
      if (random.uniform() < 0.05) body.stay(body.time() + random.uniform(0, 1));
      const auto neighbours = neighbours_of(k, robots);
      if (random.uniform() < 0.5) {
        body.take(body.evading(robots[k].wanted, neighbours, field));
      } else {
        body.take(body.following(robots[k].wanted, neighbours, field).next);
      }
    }
    for (std::size_t k = 0; k < robots.size(); ++k) {
      for (Robot& other : robots) {
        if (random.uniform() >= loss) other.heard_of[k] = robots[k].body.promise();
      }
    }
    std::vector<Point2> before;
    std::vector<Promise> promised;
    for (Robot& robot : robots) {
      before.push_back(robot.body.position());
      promised.push_back(robot.body.promise());
      const Driver present = robot.body;
      robot.body.advance();
      assert_within_limits(present, robot.body);
      RC_ASSERT(field.segment_clearance(before.back(), robot.body.position()) >= robot.body.radius() - 1e-6);
      RC_ASSERT((robot.body.position() - promised.back().position_at_decision()).norm() < 1e-9);
    }
    for (std::size_t a = 0; a < robots.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const double least =
            closest_approach(before[a], robots[a].body.position(), before[b], robots[b].body.position());
        RC_ASSERT(least >= robots[a].body.radius() + robots[b].body.radius());
      }
    }
  }
}

// A robot that commits to stand is passed as closely as a wall.
TEST(Driver, ARobotPassesAPeerThatIsBoundToStand) {
  OccupancyMap map{.width = 100, .height = 21, .blocked = std::vector<std::uint8_t>(2100, 0)};
  const ClearanceField field(map);
  const Limits limits{20, 40};
  Driver standing({50, 5.4}, 0, 5, limits, period);
  Driver passing({20, 15.5}, 0, 5, limits, period);
  for (int step = 0; step < 200; ++step) {
    standing.stay(standing.time() + 1);
    const std::vector<Neighbour> others{{standing.promise(), 5, limits}};
    passing.take(passing.following({20, 0}, others, field).next);
    standing.advance();
    passing.advance();
  }
  EXPECT_GT(passing.position().x(), 90);
}

// The straight line ahead leads into the wall, and the line beside it does not.
TEST(Driver, ARobotThatIsBlockedStraightAheadPassesBeside) {
  OccupancyMap map{.width = 100, .height = 40, .blocked = std::vector<std::uint8_t>(4000, 0)};
  for (std::size_t x = 50; x < 100; ++x) {
    for (std::size_t y = 0; y < 15; ++y) map.blocked[y * 100 + x] = 1;
  }
  const ClearanceField field(map);
  Driver body({20, 19.9}, 0, 5, {20, 40}, period);
  for (int step = 0; step < 200; ++step) {
    body.take(body.following({20, 0}, {}, field).next);
    body.advance();
  }
  EXPECT_GT(body.position().x(), 70);
}

TEST(Driver, ARobotStandsForAsLongAsItIsBound) {
  const ClearanceField field(
      OccupancyMap{.width = 50, .height = 50, .blocked = std::vector<std::uint8_t>(2500, 0)});
  Driver body({25, 25}, 0, 1, {20, 40}, period);
  body.stay(0.5);
  const double expiry = body.promise().expiry;
  EXPECT_GE(expiry, 0.5);
  while (body.time() < expiry - period / 2) {
    body.take(body.evading({20, 0}, {}, field));
    EXPECT_TRUE(body.velocity().isZero(0)) << body.time();
    body.advance();
  }
  body.take(body.evading({20, 0}, {}, field));
  body.advance();
  EXPECT_FALSE(body.velocity().isZero(0));
}

TEST(Driver, ARobotStandsForAsLongAsItAnnounced) {
  const ClearanceField field(
      OccupancyMap{.width = 100, .height = 100, .blocked = std::vector<std::uint8_t>(10000, 0)});
  for (const double until : {0.5, 0.501, 0.524, 0.525, 0.549}) {
    Driver driver({50, 50}, 0, 5, {20, 40}, 0.05);
    driver.stay(until);
    EXPECT_DOUBLE_EQ(driver.promise().expiry, until);
    while (driver.velocity().isZero(0) && driver.time() < 1) {
      driver.take(driver.evading({20, 0}, {}, field));
      driver.advance();
    }
    EXPECT_GE(driver.time(), until - 1e-6);
    EXPECT_LT(driver.time(), until + 0.11);
  }
}

TEST(Driver, ARobotLeavesAPeerThatStandsTooClose) {
  const ClearanceField field(
      OccupancyMap{.width = 100, .height = 100, .blocked = std::vector<std::uint8_t>(10000, 0)});
  const Limits limits{20, 40};
  const Point2 there(50, 50);
  const Neighbour failed{
      .promise = {.position = there, .expiry = 1e9}, .radius = 5, .limits = limits, .clock_error = 0};
  for (const double gap : {-0.01, 0.0, 0.0005}) {
    const Driver away({60 + gap, 50}, 0, 5, limits, period);
    const Driver::Followed leaves = away.following({10, 0}, {&failed, 1}, field);
    EXPECT_TRUE(leaves.is_led);
    EXPECT_GT(leaves.next.velocity.x(), 0) << gap;
    const Driver closer({60 + gap, 50}, 0, 5, limits, period);
    const Driver::Followed comes = closer.following({-10, 0}, {&failed, 1}, field);
    EXPECT_FALSE(comes.is_led);
    const Point2 next = closer.decision_position() + period * comes.next.velocity;
    EXPECT_GE((next - there).norm(), 10 + gap) << gap;
  }
}

}  // namespace
}  // namespace coppice
