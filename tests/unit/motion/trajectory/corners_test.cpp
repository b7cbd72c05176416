#include "motion/trajectory/corners.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace coppice {
namespace {

constexpr double stray = 0.3;

TEST(Corners, ARobotGainsAtMostWhatItsPlaceOnTheWayJumps) {
  // 45 degrees to the left after 10 m.
  const Path way{{0, 0}, {10, 0}, {17, 7}};
  const std::vector<Corner> corners = corners_of(way, stray);
  ASSERT_EQ(corners.size(), 1u);
  EXPECT_EQ(corners.front().at, 10);
  // The point of the strip at the inside of the corner is as near to both edges.
  const double ahead = stray * std::tan(std::numbers::pi / 8);
  EXPECT_NEAR(corners.front().jump, 2 * ahead, 1e-12);
  EXPECT_EQ(gained_at(corners, 9, 11), corners.front().jump);
  EXPECT_EQ(gained_at(corners, 10 + 0.9 * ahead, 11), corners.front().jump);
  EXPECT_EQ(gained_at(corners, 8, 10 - 0.9 * ahead), corners.front().jump);
  EXPECT_EQ(gained_at(corners, 8, 10 - 1.1 * ahead), 0);
  EXPECT_EQ(gained_at(corners, 10 + 1.1 * ahead, 16), 0);
}

TEST(Corners, WhatIsGainedAtOneCornerMayLeadToTheNext) {
  const std::vector<Corner> corners{{0.5, 0.05}, {1.04, 0.05}};
  EXPECT_DOUBLE_EQ(gained_at(corners, 0, 1), 0.1);
  EXPECT_DOUBLE_EQ(gained_at(corners, 0, 0.9), 0.05);
}

TEST(Corners, ARobotThatStandsGainsNothing) {
  EXPECT_EQ(gained_at(corners_of({{0, 0}, {10, 0}, {17, 7}}, stray), 10, 10), 0);
}

TEST(Corners, StraightWaysAndRightAnglesHaveNone) {
  EXPECT_TRUE(corners_of({{0, 0}, {5, 0}, {10, 0}}, stray).empty());
  EXPECT_TRUE(corners_of({{0, 0}, {10, 0}, {10, 7}}, stray).empty());
  EXPECT_TRUE(corners_of({{0, 0}, {10, 0}, {2, 0}}, stray).empty());
  EXPECT_TRUE(corners_of({}, stray).empty());
}

}  // namespace
}  // namespace coppice
