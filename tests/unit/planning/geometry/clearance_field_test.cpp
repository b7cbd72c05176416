// Tests of the clearance field on maps that are small enough to check by hand.
#include "coppice/planning/clearance_field.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/drawn_map.h"

namespace coppice {
namespace {

using test::drawn;

/// A corridor `width` cells wide and 60 cells long in x, between rows of blocked cells.
OccupancyMap corridor(int width) {
  std::vector<std::string> rows(static_cast<std::size_t>(width) + 2, std::string(60, '.'));
  rows.front() = rows.back() = std::string(60, '#');
  return drawn(rows);
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(ClearanceField, ClearanceIsTheDistanceToTheNearestPointOfACell) {
  const ClearanceField field(
      drawn({"...........", "...........", "...........", "...........", "...........", ".....#.....",
             "...........", "...........", "...........", "...........", "..........."}));
  EXPECT_NEAR(field.clearance({5.3, 3.0}), 2.0, 1e-12);             // straight above the square
  EXPECT_NEAR(field.clearance({3.0, 3.0}), std::sqrt(8.0), 1e-12);  // from a corner of the square
  EXPECT_NEAR(field.clearance({8.0, 5.5}), 2.0, 1e-12);             // beside the square
  EXPECT_EQ(field.clearance({5.5, 5.5}), 0.0);                      // inside the square
  EXPECT_EQ(field.clearance({6.0, 5.5}), 0.0);                      // on the edge of the square
  EXPECT_NEAR(field.clearance({6.0 + 1e-3, 5.5}), 1e-3, 1e-12);     // just off the edge
  EXPECT_NEAR(field.clearance({0.25, 7.0}), 0.25, 1e-12);           // the border of the map is nearer
}

TEST(ClearanceField, TheOutsideOfTheMapIsBlocked) {
  const ClearanceField field(drawn(std::vector<std::string>(20, std::string(30, '.'))));
  EXPECT_NEAR(field.clearance({15, 10}), 10.0, 1e-12);
  EXPECT_NEAR(field.clearance({28, 10}), 2.0, 1e-12);
  EXPECT_EQ(field.clearance({0, 10}), 0.0);
  EXPECT_TRUE(field.is_free({5, 5}, 5));
  EXPECT_FALSE(field.is_free({5, 5 - 1e-6}, 5));
  EXPECT_FALSE(field.is_free({-1, 10}, 0.1));
  EXPECT_FALSE(field.is_free({15, 20.5}, 0.1));
  EXPECT_FALSE(field.segment_free({5, 5}, {35, 5}, 1));
}

TEST(ClearanceField, ADiscAsWideAsACorridorPassesOnlyAlongTheMiddle) {
  const ClearanceField field(corridor(10));
  EXPECT_TRUE(field.is_free({30, 6}, 5));
  EXPECT_TRUE(field.segment_free({5, 6}, {55, 6}, 5));
  EXPECT_FALSE(field.is_free({30, 6 + 1e-6}, 5));
  EXPECT_FALSE(field.segment_free({5, 6}, {55, 6 + 1e-6}, 5));
  EXPECT_FALSE(field.segment_free({5, 6}, {55, 6}, 5 + 1e-6));
  EXPECT_NEAR(field.segment_clearance({5, 6}, {55, 6}), 5.0, 1e-12);
  EXPECT_NEAR(field.segment_clearance({20, 6}, {40, 4}), 3.0, 1e-12);
}

TEST(ClearanceField, ATightCorridorStaysPassableInAFineMapWithAnOrigin) {
  OccupancyMap map = corridor(10);
  map.resolution = 0.05;
  map.origin = Point2(-1.37, 103.61);
  const ClearanceField field(map);
  const auto at = [&](double x, double y) { return Point2(map.origin + map.resolution * Point2(x, y)); };
  EXPECT_TRUE(field.is_free(at(30, 6), 0.25));
  EXPECT_TRUE(field.segment_free(at(5, 6), at(55, 6), 0.25));
  EXPECT_FALSE(field.is_free(at(30, 6.001), 0.25));
  EXPECT_FALSE(field.segment_free(at(5, 6), at(55, 6), 0.2501));
  EXPECT_NEAR(field.clearance(at(30, 4)), 0.15, 1e-12);
  EXPECT_LE(field.lower_bound(at(30, 4)), 0.15 + 1e-12);
}

TEST(ClearanceField, DiscsSmallerThanACellPassBetweenBlockedCells) {
  const ClearanceField field(drawn({"#.#####", "#.....#", "###.###", "#.....#", "#######"}));
  EXPECT_TRUE(field.is_free({3.5, 2.5}, 0.3));
  EXPECT_TRUE(field.segment_free({3.5, 1.5}, {3.5, 3.5}, 0.3));
  EXPECT_TRUE(field.segment_free({3.3, 1.5}, {3.3, 3.5}, 0.3));
  EXPECT_FALSE(field.segment_free({3.3, 1.5}, {3.3, 3.5}, 0.31));
  EXPECT_FALSE(field.segment_free({1.5, 1.5}, {1.5, 3.5}, 0.3));  // through a wall, both ends free
  EXPECT_FALSE(field.segment_free({1.5, 1.5}, {5.5, 3.5}, 0.3));  // cuts the corners of the gap
}

TEST(ClearanceField, APointMayNeitherEnterNorTouchAnObstacle) {
  const ClearanceField field(drawn({".....", ".#...", "..#..", "....."}));
  EXPECT_TRUE(field.is_free({0.5, 0.5}, 0));
  EXPECT_FALSE(field.is_free({1.5, 1.5}, 0));
  EXPECT_FALSE(field.is_free({2, 1.5}, 0));
  EXPECT_FALSE(field.segment_free({2.5, 1.5}, {1.5, 2.5}, 0));  // between two squares that share a corner
  EXPECT_TRUE(field.segment_free({2.6, 1.5}, {4.5, 1.5}, 0));
}

TEST(ClearanceField, SegmentsInsideOrThroughAnObstacleAreNotFree) {
  std::vector<std::string> rows(40, std::string(40, '.'));
  for (std::size_t j = 10; j < 30; ++j) rows[j].replace(10, 20, std::string(20, '#'));
  const ClearanceField field(drawn(rows));
  EXPECT_FALSE(field.is_free({20.2, 20.7}, 0));
  EXPECT_EQ(field.segment_clearance({15, 15}, {25, 20}), 0.0);
  EXPECT_FALSE(field.segment_free({15, 15}, {25, 20}, 0));
  EXPECT_EQ(field.segment_clearance({5, 5}, {35, 33}), 0.0);
  EXPECT_FALSE(field.segment_free({5, 5}, {35, 33}, 0.5));
  EXPECT_TRUE(field.segment_free({5, 5}, {35, 5}, 5));
}

TEST(ClearanceField, PointsAndRadiiThatAreNotFiniteAreNotFree) {
  const ClearanceField field(drawn(std::vector<std::string>(20, std::string(20, '.'))));
  for (const Point2& p : {Point2(nan, 10), Point2(10, nan), Point2(infinity, 10), Point2(10, -infinity)}) {
    EXPECT_FALSE(field.is_free(p, 1));
    EXPECT_FALSE(field.segment_free(p, {10, 10}, 1));
    EXPECT_FALSE(field.segment_free({10, 10}, p, 1));
    EXPECT_EQ(field.lower_bound(p), 0.0);
    EXPECT_EQ(field.clearance(p), 0.0);
  }
  EXPECT_FALSE(field.is_free({10, 10}, nan));
  EXPECT_FALSE(field.is_free({10, 10}, infinity));
  EXPECT_FALSE(field.segment_free({10, 10}, {11, 10}, nan));
}

TEST(ClearanceField, AMapWithoutAFreeCellIsNowhereFree) {
  const ClearanceField field(drawn({"#"}));
  EXPECT_FALSE(field.is_free({0.5, 0.5}, 0));
  EXPECT_EQ(field.clearance({0.5, 0.5}), 0.0);
  const ClearanceField single(drawn({"."}));
  EXPECT_TRUE(single.is_free({0.5, 0.5}, 0.5));
  EXPECT_FALSE(single.is_free({0.5, 0.5}, 0.51));
}

TEST(ClearanceField, TheFieldVisitsTheEdgesOfObstaclesNearAPoint) {
  std::vector<std::string> rows(100, std::string(100, '.'));
  for (std::size_t j = 60; j < 70; ++j) rows[j].replace(60, 10, "##########");
  OccupancyMap map = drawn(rows);
  map.resolution = 0.5;
  const ClearanceField field(map);
  const auto count_near = [&](const Point2& p, double distance) {
    int count = 0;
    field.for_each_edge_near(p, distance, [&](const Box<2>& square) {
      ++count;
      EXPECT_NEAR((square.upper - square.lower - Point2(0.5, 0.5)).norm(), 0, 1e-12);
      EXPECT_EQ(field.clearance(0.5 * (square.lower + square.upper)), 0.0);
    });
    return count;
  };
  EXPECT_EQ(count_near({25, 25}, 100), 36);  // the cells at the rim of the square, without the inner cells
  EXPECT_EQ(count_near({25.25, 32.25}, 4), 0);
  EXPECT_GE(count_near({25.25, 32.25}, 5), 1);
  EXPECT_EQ(count_near({60, 25}, 100), 0);
}

}  // namespace
}  // namespace coppice
