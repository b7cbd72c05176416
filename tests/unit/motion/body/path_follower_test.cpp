#include "motion/body/path_follower.h"

#include <gtest/gtest.h>

#include "coppice/planning/clearance_field.h"

namespace coppice {
namespace {

const OccupancyMap hall{.width = 120, .height = 40, .blocked = std::vector<std::uint8_t>(4800, 0)};

TEST(PathFollower, TheRemainingWayIsMeasuredFromTheRobotsPosition) {
  const ClearanceField field(hall);
  PathFollower follower({{10, 20}, {110, 20}}, 1);
  ASSERT_TRUE(follower.look_from({10, 20}, field, {2, 2}));
  EXPECT_DOUBLE_EQ(follower.way_left({10, 20}), 100);
  EXPECT_DOUBLE_EQ(follower.way_left({70, 23}), 43) << "a joint plan led the robot along its path";
  EXPECT_DOUBLE_EQ(follower.way_left({70, 23}), 43) << "the query does not move the follower";
}

TEST(PathFollower, TheRobotHeadsAlongItsPathAndSlowsDownForItsEnd) {
  const ClearanceField field(hall);
  const Limits limits{20, 40};
  PathFollower follower({{10, 20}, {50, 20}}, 5);
  ASSERT_TRUE(follower.look_from({15, 20}, field, limits));
  EXPECT_TRUE(follower.preferred_velocity({15, 20}, limits, 0.05).isApprox(Point2(20, 0)));
  ASSERT_TRUE(follower.look_from({49, 20}, field, limits));
  const Point2 near_the_end = follower.preferred_velocity({49, 20}, limits, 0.05);
  EXPECT_GT(near_the_end.x(), 0);
  EXPECT_LT(near_the_end.x(), 10);
}

TEST(PathFollower, ARobotBehindAWallDoesNotSeeItsPath) {
  OccupancyMap divided = hall;
  for (std::size_t i = 0; i < 120; ++i) divided.blocked[20 * 120 + i] = 1;
  const ClearanceField field(divided);
  PathFollower follower({{10, 10}, {110, 10}}, 1);
  EXPECT_TRUE(follower.look_from({30, 12}, field, {20, 40}));
  EXPECT_FALSE(follower.look_from({30, 30}, field, {20, 40}));
}

}  // namespace
}  // namespace coppice
