// Tests of how a robot drives along a way.
#include "motion/body/way_follower.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "motion/body/driver.h"
#include "motion/trajectory/corner_speed.h"
#include "motion/trajectory/segments.h"
#include "motion/trajectory/space_time.h"
#include "motion/trajectory/wide_corners.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

constexpr double period = 0.05;
constexpr double open = std::numeric_limits<double>::infinity();

// In a period it drives several of its radii.
TEST(WayFollower, ASmallFastRobotKeepsItsSpeed) {
  const Limits limits{20, 40};
  const double radius = 0.5;
  WayFollower follower(std::vector<Path>{{{0, 0}, {200, 0}}}, radius, 0.05 * radius);
  const Point2 wanted = follower.preferred_velocity({0, 0}, limits, period, open);
  EXPECT_NEAR(wanted.x(), limits.max_speed, 1e-6);
  for (int k = 1; k <= 20; ++k) follower.come_to({k * limits.max_speed * period, 0});
  EXPECT_NEAR(follower.progress(), 20, 1e-6);
}

TEST(WayFollower, ARobotDoesNotDrivePastWhereTheWayIsOpen) {
  const Limits limits{20, 40};
  WayFollower follower(std::vector<Path>{{{0, 0}, {200, 0}}}, 5, 0.25);
  Point2 position(0, 0);
  for (int step = 0; step < 200; ++step) {
    follower.come_to(position);
    position += period * follower.preferred_velocity(position, limits, period, 30);
  }
  EXPECT_LE(position.x(), 30 + 1e-6);
  EXPECT_GT(position.x(), 29);
}

TEST(WayFollower, ARobotStopsBeforeWhatLiesInItsWay) {
  const WayFollower follower(std::vector<Path>{{{0, 0}, {50, 0}}, {{50, 0}, {50, 50}}}, 5, 0.25);
  EXPECT_NEAR(follower.stop_before({30, 0}, 10, 12, 100), 18, 1e-9);
  EXPECT_NEAR(follower.stop_before({50, 30}, 10, 12, 100), 68, 1e-9);
  EXPECT_NEAR(follower.stop_before({58, 8}, 10, 12, 100), 58 - std::sqrt(144 - 64), 1e-9)
      << "around the corner";
  EXPECT_NEAR(follower.stop_before({8, 0}, 10, 12, 100), 0, 1e-9) << "it is close already";
  EXPECT_EQ(follower.stop_before({30, 11}, 10, 12, 100), open) << "the way passes it";
  EXPECT_EQ(follower.stop_before({50, 30}, 10, 12, 65), open) << "it is far ahead";
}

// It does not creep for the last millimetres.
TEST(WayFollower, ARobotComesToStandAtTheEndAsSoonAsItsLimitsAllow) {
  for (const Limits limits : {Limits{20, 40}, Limits{1, 2}, Limits{1, 10}}) {
    for (double length = 3; length < 3.5; length += 0.013) {
      WayFollower follower(std::vector<Path>{{{0, 0}, {length * limits.max_speed, 0}}},
                           0.3 * limits.max_speed, 0.01);
      Point2 position(0, 0);
      Point2 velocity(0, 0);
      int steps = 0;
      do {
        follower.come_to(position);
        const Point2 wanted = follower.preferred_velocity(position, limits, period, open);
        velocity = within_limits(wanted, velocity, limits, period);
        position += period * velocity;
        ++steps;
      } while (!velocity.isZero(0) && steps < 1000);
      EXPECT_NEAR(position.x(), length * limits.max_speed, 1e-9);
      EXPECT_LE(steps * period, free_flow_time(length * limits.max_speed, limits) + 4 * period) << length;
    }
  }
}

/// Drives along a way in its strip until the end, and returns the seconds that takes. `yaw`: of a
/// differential robot at the start.
double driven(const Path& way, double radius, const Limits& limits, double yaw = 0) {
  static const ClearanceField field(test::open_map(300, 300));
  const double stray = reserved_stray_radii * radius;
  WayFollower follower(std::vector<Path>{way}, radius, stray);
  Driver body(way.front(), 0, radius, limits, period, yaw);
  const auto stays_in_strip = [&](Twist twist) {
    Point2 here = body.decision_position();
    double along = follower.progress();
    for (; !twist.velocity.isZero(0); twist = braked(twist, limits, period)) {
      const auto comes_to = follower.along_strip(here, here + period * twist.velocity, along);
      if (!comes_to) return false;
      here += period * twist.velocity;
      along = *comes_to;
    }
    return true;
  };
  while (!follower.finished() && body.time() < 1000) {
    follower.come_to(body.decision_position());
    const Point2 wanted =
        body.slow_to_turn(follower.preferred_velocity(body.decision_position(), limits, period, open), stray);
    body.take(body.following(wanted, {}, field, stays_in_strip).next);
    body.advance();
    EXPECT_LE(point_path_distance(body.position(), way), stray + 1e-6) << body.time();
  }
  return body.time();
}

TEST(WayFollower, ARobotLosesAtACornerNoMoreThanASearchReckonsWith) {
  const Limits limits{20, 40};
  const double straight = driven({{20, 20}, {220, 20}}, 5, limits);
  for (const double degrees : {5, 15, 25, 35, 45, 60, 75, 85}) {
    const double turn = degrees * std::numbers::pi / 180;
    const Point2 out(std::cos(turn), std::sin(turn));
    const double lost = driven({{20, 20}, {120, 20}, Point2(120, 20) + 100 * out}, 5, limits) - straight;
    const double reckoned = time_lost_around({1, 0}, out, reserved_stray_radii * 5, limits);
    EXPECT_LE(lost, 1.3 * reckoned + 0.06) << degrees;
    EXPECT_GE(lost, 0.4 * reckoned - 0.06) << degrees;
  }
}

TEST(WayFollower, ARobotTakesNoLongerForWideCornersAndMostlyLess) {
  const Limits limits{20, 40};
  OccupancyMap map = test::open_map(300, 300);
  test::block(map, 0, 126, 115, 299);  // inside of the turn
  const ClearanceField field(map);
  double all = 0;  // seconds
  for (const double degrees : {15, 25, 35, 45, 60, 80}) {
    const double turn = degrees * std::numbers::pi / 180;
    const Point2 out(std::cos(turn), std::sin(turn));
    const Path path{{20, 120}, {120, 120}, Point2(120, 120) + 100 * out};
    const Path wide = with_wide_corners(path, field, 5, reserved_stray_radii * 5, limits);
    const double gained = driven(path, 5, limits) - driven(wide, 5, limits);
    EXPECT_GE(gained, -1e-9) << degrees;
    all += gained;
  }
  EXPECT_GT(all, 0.1);
}

// A robot that does not see its turns coming swings from one edge of its strip to the other, and stops at
// each.
TEST(WayFollower, ADifferentialRobotThatTurnsSlowlyLosesLittleBesideItsTurns) {
  const Path straight{{20, 20}, {100, 20}};
  const Path bent{{20, 20}, {60, 20}, {100, 30}};
  const Path zigzag{{20, 20}, {30, 25}, {40, 20}, {50, 25}, {60, 20}, {70, 25}};
  const Path stairs{{20, 20}, {30, 20}, {30, 30}, {40, 30}, {40, 40}};
  const double radius = 0.3;
  for (const Limits& limits : {Limits{5, 1, 0.5, 0.1}, Limits{9.9, 0.35, 0.23, 0.043}, Limits{5, 2, 2, 4}}) {
    for (const Path& way : {straight, bent, zigzag, stairs}) {
      for (const double yaw : {0.0, 0.3, -2.0}) {
        // At the most it stops at each corner.
        double seconds = 0;
        double heading = yaw;
        for (std::size_t k = 1; k < way.size(); ++k) {
          const Point2 edge = way[k] - way[k - 1];
          const double along = std::atan2(edge.y(), edge.x());
          seconds += time_to_turn(wrapped(along - heading), limits) + free_flow_time(edge.norm(), limits);
          heading = along;
        }
        EXPECT_LT(driven(way, radius, limits, yaw), 1.2 * seconds)
            << limits.max_angular_acceleration << ", " << way.size() << " points, yaw " << yaw;
      }
    }
  }
}

TEST(WayFollower, ARobotRoundsCornersThatFollowCloselyOnEachOther) {
  Path bend{{20, 20}};
  for (int k = 0; k <= 9; ++k) {
    const double angle = k * std::numbers::pi / 18;
    bend.emplace_back(80 + 30 * std::sin(angle), 50 - 30 * std::cos(angle));
  }
  bend.emplace_back(110, 110);
  EXPECT_LT(driven(bend, 5, {20, 40}), length_of(bend) / 20 + 0.5 + 1);
}

}  // namespace
}  // namespace coppice
