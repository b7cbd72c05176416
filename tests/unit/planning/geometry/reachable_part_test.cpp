// Tests of what a disc reaches, on maps that are drawn with one character for each cell; @ is blocked.
#include <gtest/gtest.h>

#include "planning/geometry/reachability.h"
#include "tests/drawn_map.h"

namespace coppice {
namespace {

using test::drawn;

const std::vector<std::string> rooms_with_a_door{"@@@@@@@@@",  //
                                                 "@...@...@",  //
                                                 "@.......@",  //
                                                 "@...@...@",  //
                                                 "@@@@@@@@@"};

TEST(ReachablePart, ThePartLeadsThroughADoorOfOneCell) {
  const ClearanceField field(drawn(rooms_with_a_door));
  for (const double radius : {0.3, 0.4, 0.49, 0.5}) {
    EXPECT_EQ(ReachablePart::largest(field, radius).size(), 19u) << radius;
    EXPECT_TRUE(ReachablePart::around(field, radius, {1.5, 1.5}).contains({7.5, 3.5})) << radius;
  }
  EXPECT_EQ(ReachablePart::largest(field, 0.51).size(), 2u);  // the middle of a room, and before the door
  EXPECT_FALSE(ReachablePart::around(field, 0.51, {2.5, 2.5}).contains({6.5, 2.5}));
}

TEST(ReachablePart, ThePartListsItsPlacesRowByRowAndHasABox) {
  const ClearanceField field(drawn({"@@@@", "@..@", "@.@@", "@@@@"}));
  const ReachablePart part = ReachablePart::largest(field, 0.4);
  ASSERT_EQ(part.size(), 3u);
  EXPECT_EQ(part.place(0), Point2(1.5, 1.5));
  EXPECT_EQ(part.place(1), Point2(2.5, 1.5));
  EXPECT_EQ(part.place(2), Point2(1.5, 2.5));
  EXPECT_EQ(part.box().lower, Point2(1.5, 1.5));
  EXPECT_EQ(part.box().upper, Point2(2.5, 2.5));
}

TEST(ReachablePart, ThePartEndsAtCornersThatTouch) {
  const ClearanceField field(drawn({"..@@", "..@@", "@@..", "@@.."}));
  const ReachablePart part = ReachablePart::around(field, 0.3, {1, 1});
  EXPECT_EQ(part.size(), 4u);
  EXPECT_TRUE(part.contains({0.4, 1.6}));
  EXPECT_FALSE(part.contains({2.5, 2.5}));
}

// In a passage two cells wide, no cell centre is free for a disc that nearly fills the passage.
TEST(ReachablePart, ThePartIncludesPassagesTwoCellsWide) {
  const ClearanceField field(drawn({"......", "......"}));
  for (const double radius : {0.7, 1.0}) {
    const ReachablePart part = ReachablePart::largest(field, radius);
    ASSERT_FALSE(part.empty()) << radius;
    EXPECT_EQ(part.box().lower, Point2(1, 1)) << radius;
    EXPECT_EQ(part.box().upper, Point2(5, 1)) << radius;
  }
  EXPECT_TRUE(ReachablePart::largest(field, 1.01).empty());
}

// The gap lies askew to the axes: the lattice point in its middle has no free neighbour.
TEST(ReachablePart, ThePartLeadsAskewBetweenTwoCorners) {
  std::vector<std::string> rows(12, std::string(12, '.'));
  for (int j = 0; j < 5; ++j) rows[static_cast<std::size_t>(j)][5] = '@';   // its corner is (6, 5)
  for (int j = 8; j < 12; ++j) rows[static_cast<std::size_t>(j)][7] = '@';  // its corner is (7, 8)
  const ClearanceField field(drawn(rows));
  for (const double radius : {1.4, 1.55, 1.58}) {
    EXPECT_TRUE(ReachablePart::around(field, radius, {2, 6}).contains({10, 6})) << radius;
    EXPECT_TRUE(ReachablePart::around(field, radius, {10, 6}).contains({2, 6})) << radius;
  }
  EXPECT_FALSE(ReachablePart::around(field, 1.59, {2, 6}).contains({10, 6}));
}

TEST(ReachablePart, ThePartIsEmptyWhereTheDiscDoesNotFit) {
  const ClearanceField field(drawn(rooms_with_a_door));
  EXPECT_TRUE(ReachablePart::around(field, 0.4, {4.5, 1.5}).empty());  // in the wall
  EXPECT_TRUE(ReachablePart::around(field, 0.4, {1.3, 1.5}).empty());  // too near to the wall
  EXPECT_TRUE(ReachablePart::around(field, 0.4, {-3, 1.5}).empty());   // outside of the map
  EXPECT_FALSE(ReachablePart::largest(field, 0.4).contains({-3, 1.5}));
  EXPECT_TRUE(ReachablePart::largest(field, 3).empty());
}

TEST(ReachablePart, ThePartIsExactOnFineMapsFarFromTheOrigin) {
  OccupancyMap map = drawn(rooms_with_a_door);
  map.resolution = 0.05;
  map.origin = {500000.123, 5400000.456};
  const ClearanceField field(map);
  EXPECT_EQ(ReachablePart::largest(field, 0.02).size(), 19u);
  EXPECT_EQ(ReachablePart::largest(field, 0.024).place(0), map.origin + 0.05 * Point2(1.5, 1.5));
}

}  // namespace
}  // namespace coppice
