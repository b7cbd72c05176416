// Tests of how a robot drives along a way.
#include "motion/way_follower.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

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
}

TEST(WayFollower, ARobotDoesNotDrivePastWhereTheWayIsOpen) {
  const Limits limits{20, 40};
  WayFollower follower(std::vector<Path>{{{0, 0}, {200, 0}}}, 5, 0.25);
  Point2 position(0, 0);
  for (int step = 0; step < 200; ++step)
    position += period * follower.preferred_velocity(position, limits, period, 30);
  EXPECT_LE(position.x(), 30 + 1e-6);
  EXPECT_GT(position.x(), 29);
}

}  // namespace
}  // namespace coppice
