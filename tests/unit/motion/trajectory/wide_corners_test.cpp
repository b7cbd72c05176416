// Tests of corners that are rounded to save time, and of the times along a given path.
#include "motion/trajectory/wide_corners.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "motion/trajectory/corner_speed.h"
#include "motion/trajectory/earliest_along.h"
#include "motion/trajectory/space_time.h"
#include "tests/unit/motion/plans.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::radius;
constexpr double usual_stray = reserved_stray_radii * radius;
constexpr Limits limits{20, 40};

Path corner(double degrees) {
  const double turn = degrees * std::numbers::pi / 180;
  return {{20, 100}, {120, 100}, Point2(120, 100) + 100 * Point2(std::cos(turn), std::sin(turn))};
}

Path wide(const Path& path, const OccupancyMap& map) {
  return with_wide_corners(path, ClearanceField(map), radius, usual_stray, limits);
}

double seconds_along(const Path& path) {
  SpaceTime nobody({{0, 0}, {300, 300}}, radius);
  return earliest_along(path, nobody, 0, usual_stray, limits)->back().time;
}

TEST(WideCorners, SlightTurnsAlongAnArcReplaceASharpOne) {
  OccupancyMap map = test::open_map(300, 300);
  test::block(map, 0, 106, 115, 299);  // inside of the turn
  for (const double degrees : {20, 40, 70}) {
    const Path path = corner(degrees);
    const Path rounded = wide(path, map);
    ASSERT_GT(rounded.size(), 3u) << degrees;
    EXPECT_EQ(rounded.front(), path.front());
    EXPECT_EQ(rounded.back(), path.back());
    EXPECT_LT(seconds_along(rounded), seconds_along(path) - 0.01) << degrees;
  }
}

TEST(WideCorners, TheNewEdgesKeepTheirClearance) {
  OccupancyMap map = test::open_map(300, 300);
  test::block(map, 0, 106, 115, 299);  // inside of the turn
  test::block(map, 0, 0, 299, 89);     // outside
  const ClearanceField field(map);
  const Path path = corner(60);
  const Path rounded = wide(path, map);
  EXPECT_GT(rounded.size(), 3u);
  for (std::size_t k = 1; k < rounded.size(); ++k)
    EXPECT_TRUE(field.segment_free(rounded[k - 1], rounded[k], radius)) << k;
  test::block(map, 0, 0, 299, 94);
  EXPECT_EQ(wide(path, map), path) << "there is no room beside the path";
}

TEST(WideCorners, NeedlessCornersThatFollowCloselyOnEachOtherAreLeftOut) {
  const Path zigzag{{20, 100}, {100, 100}, {103, 102}, {106, 102}, {109, 100}, {200, 100}};
  EXPECT_LE(wide(zigzag, test::open_map(300, 300)).size(), 3u);
}

TEST(WideCorners, AStraightPathStaysAsItIs) {
  const Path straight{{20, 100}, {100, 100}, {200, 100}};
  EXPECT_EQ(length_of(wide(straight, test::open_map(300, 300))), length_of(straight));
  const Path point{{20, 100}, {20, 100}};
  EXPECT_EQ(wide(point, test::open_map(300, 300)), point);
}

TEST(EarliestAlong, ARobotAloneLosesTimeAtCornersOnly) {
  const Path path = corner(40);
  SpaceTime nobody({{0, 0}, {300, 300}}, radius);
  const auto found = earliest_along(path, nobody, 3, usual_stray, limits);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->front(), (TimedPoint{3, path.front()}));
  EXPECT_NEAR(found->back().time, 3 + length_of(path) / 20 + time_lost_at(path, 1, usual_stray, limits),
              1e-9);
  EXPECT_EQ(path_of(*found), path);
}

TEST(EarliestAlong, ARobotLetsOthersPassAndComesNoCloser) {
  const Path path = corner(40);
  SpaceTime others({{0, 0}, {300, 300}}, radius);
  const Trajectory crossing{{0, {80, 160}}, {6, {80, 20}}};
  others.add(crossing, radius);
  const auto found = earliest_along(path, others, 0, usual_stray, limits);
  ASSERT_TRUE(found);
  EXPECT_GT(found->back().time, seconds_along(path) + 0.3);
  EXPECT_FALSE(come_too_close(*found, crossing, kept_apart(radius, radius) - 1e-6, 0));
}

TEST(EarliestAlong, NothingIsFoundIfTheRobotCannotStayAtTheEnd) {
  const Path path = corner(40);
  SpaceTime others({{0, 0}, {300, 300}}, radius);
  others.add_standing(path.back(), radius, SpaceTime::forever);
  EXPECT_FALSE(earliest_along(path, others, 0, usual_stray, limits));
}

}  // namespace
}  // namespace coppice
