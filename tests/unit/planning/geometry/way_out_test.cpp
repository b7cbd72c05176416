// Tests of the way out of a disc that overlaps an obstacle a little.
#include "planning/geometry/way_out.h"

#include <cmath>

#include <gtest/gtest.h>

namespace coppice {
namespace {

constexpr double radius = 0.4;
constexpr double most = 0.1;

/// A room of 10 m x 10 m: the border is an obstacle.
ClearanceField room() {
  return ClearanceField(
      {.width = 100, .height = 100, .resolution = 0.1, .blocked = std::vector<std::uint8_t>(10000, 0)});
}

TEST(WayOut, ADiscThatIsFreeStays) {
  EXPECT_EQ(way_out(room(), {5, 5}, radius, most), Point2(5, 5));
  EXPECT_EQ(way_out(room(), {radius, 5}, radius, most), Point2(radius, 5));
}

TEST(WayOut, ItLeadsStraightAwayFromAWall) {
  const ClearanceField field = room();
  for (const double overlap : {1e-5, 0.01, 0.05, 0.099}) {
    const Point2 p(radius - overlap, 5);
    const auto out = way_out(field, p, radius, most);
    ASSERT_TRUE(out) << overlap;
    EXPECT_TRUE(field.is_free(*out, radius));
    EXPECT_LE((*out - p).norm(), 1.3 * overlap + 1e-5) << overlap;
    EXPECT_TRUE(leads_out(field, p, *out, radius));
  }
}

TEST(WayOut, ItLeadsOutOfACorner) {
  const ClearanceField field = room();
  const auto out = way_out(field, {radius - 0.05, radius - 0.03}, radius, most);
  ASSERT_TRUE(out);
  EXPECT_TRUE(field.is_free(*out, radius));
  EXPECT_LE((*out - Point2(radius, radius)).norm(), 0.06);
}

TEST(WayOut, ADiscThatOverlapsByMoreOrHasNoRoomHasNone) {
  EXPECT_FALSE(way_out(room(), {radius - 0.11, 5}, radius, most));
  EXPECT_FALSE(way_out(room(), {-1, 5}, radius, most)) << "off the map";
  const ClearanceField lane(
      {.width = 100, .height = 7, .resolution = 0.1, .blocked = std::vector<std::uint8_t>(700, 0)});
  EXPECT_FALSE(way_out(lane, {5, 0.35}, radius, most)) << "a lane of 0.7 m";
}

TEST(WayOut, AWayOnWhichTheClearanceShrinksDoesNotLeadOut) {
  const ClearanceField field = room();
  EXPECT_FALSE(leads_out(field, {0.3, 5}, {0.25, 5}, radius));
  EXPECT_TRUE(leads_out(field, {0.3, 5}, {2, 5}, radius));
  EXPECT_TRUE(leads_out(field, {5, 5}, {4, 5}, radius)) << "it is free all the way";
}

}  // namespace
}  // namespace coppice
