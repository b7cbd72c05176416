// Tests of the division of a way into a first part and the rest.
#include "motion/trajectory/divided_way.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

constexpr std::size_t many = 100;
const Path way{{0, 0}, {10, 0}, {10, 5}, {20, 5}};

TEST(DividedWay, AShortWayHasNoRest) {
  const DividedWay parts = divided(way, 25, many);
  EXPECT_EQ(parts.first, way);
  EXPECT_TRUE(parts.rest.empty());
}

TEST(DividedWay, TheRestBeginsWhereTheFirstPartEnds) {
  const DividedWay parts = divided(way, 12, many);
  EXPECT_EQ(parts.first, Path({{0, 0}, {10, 0}, {10, 2}}));
  EXPECT_EQ(parts.rest, Path({{10, 2}, {10, 5}, {20, 5}}));
}

TEST(DividedWay, TheFirstPartHasFewCorners) {
  const DividedWay parts = divided(way, 25, 1);
  EXPECT_EQ(parts.first, Path({{0, 0}, {10, 0}, {10, 5}}));
  EXPECT_EQ(parts.rest, Path({{10, 5}, {20, 5}}));
}

TEST(DividedWay, AWayOfOnePointIsAFirstPart) {
  const DividedWay parts = divided({{3, 4}}, 25, many);
  EXPECT_EQ(parts.first, Path({{3, 4}}));
  EXPECT_TRUE(parts.rest.empty());
}

}  // namespace
}  // namespace coppice
