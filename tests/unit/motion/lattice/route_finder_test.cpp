#include "motion/lattice/route_finder.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "motion/trajectory/segments.h"

namespace coppice {
namespace {

OccupancyMap open_map(int width, int height) {
  return {.width = width,
          .height = height,
          .blocked = std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), 0)};
}

double least_distance(const Path& path, const Point2& p) {
  double least = 1e9;
  for (std::size_t k = 1; k < path.size(); ++k)
    least = std::min(least, point_segment_distance(p, path[k - 1], path[k]));
  return least;
}

TEST(RouteFinder, TheRouteIsStraightWithoutObstacles) {
  const ClearanceField field(open_map(100, 60));
  RouteFinder finder(field, 5, 2);
  const Path path = finder.route({10, 30}, {90, 31}, {});
  ASSERT_EQ(path.size(), 2u);
  EXPECT_EQ(path.back(), Point2(90, 31));
}

TEST(RouteFinder, TheRouteGoesAroundADiscAndNotFurtherThanNeeded) {
  const ClearanceField field(open_map(100, 60));
  RouteFinder finder(field, 5, 2);
  const std::vector<Disc> discs{{{50, 30}, 5}};
  const Path path = finder.route({10, 30}, {90, 30}, discs);
  ASSERT_GT(path.size(), 2u);
  EXPECT_GE(least_distance(path, {50, 30}), 10 + standing_gap);
  EXPECT_LT(length_of(path), 84);  // 82.6 m around a disc of 10.5 m
}

TEST(RouteFinder, NoRouteLeadsThroughAClosedDoorOrToATakenGoal) {
  OccupancyMap map = open_map(100, 60);
  for (int j = 0; j < 60; ++j) map.blocked[static_cast<std::size_t>(j * 100 + 50)] = j < 24 || j >= 36;
  const ClearanceField field(map);
  RouteFinder finder(field, 5, 2);
  EXPECT_FALSE(finder.route({20, 30}, {80, 30}, {}).empty());
  EXPECT_TRUE(finder.route({20, 30}, {80, 30}, std::vector<Disc>{{{50, 30}, 3}}).empty());
  EXPECT_TRUE(finder.route({20, 30}, {80, 30}, std::vector<Disc>{{{80, 39}, 5}}).empty());
}

// The robot stands between two others that it almost touches, with a third one behind it. The way out leads
// in any direction.
TEST(RouteFinder, TheRouteLeavesADeadlockBetweenLatticePoints) {
  const ClearanceField field(open_map(140, 140));
  const Point2 from(70.37, 70.61);
  const double touching = 10 + standing_gap;
  for (int degrees = 0; degrees < 360; ++degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const Point2 ahead(std::cos(angle), std::sin(angle));
    const Point2 aside(-ahead.y(), ahead.x());
    const std::vector<Disc> discs{{from + (touching + 0.02) * aside, 5},
                                  {from - (touching + 0.02) * aside, 5},
                                  {from - (touching + 0.5) * ahead, 5}};
    EXPECT_FALSE(coarsest_route(field, 5, from, from + 30 * ahead + 20 * aside, discs).empty())
        << degrees << " degrees";
  }
}

// A passage exactly as wide as the robot, where a coarse lattice has no points.
TEST(RouteFinder, ThePassageWithoutSlackIsFound) {
  OccupancyMap map = open_map(60, 41);
  for (int j = 0; j < 41; ++j) {
    for (int i = 20; i < 40; ++i) map.blocked[static_cast<std::size_t>(j * 60 + i)] = j < 15 || j >= 24;
  }
  const ClearanceField field(map);
  RouteFinder finder(field, 4.5, 0.1);  // half a cell
  EXPECT_FALSE(finder.route({10, 20}, {50, 20}, {}).empty());
}

}  // namespace
}  // namespace coppice
