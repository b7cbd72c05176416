#include "planning/geometry/even_points.h"

#include <array>

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(EvenPoints, ThePointsVisitEveryPartOfTheBoxSoon) {
  const Box<2> box{{-3, 10}, {5, 14}};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    EvenPoints<2> points(box, random);
    std::array<int, 256> visits{};
    for (int k = 0; k < 4 * 256; ++k) {
      const Point2 share = (points.next() - box.lower).array() / (box.upper - box.lower).array();
      ASSERT_TRUE(share.minCoeff() >= 0 && share.maxCoeff() <= 1);
      const auto cell = [](double s) { return std::min(15, static_cast<int>(16 * s)); };
      ++visits[static_cast<std::size_t>(16 * cell(share.y()) + cell(share.x()))];
    }
    // Random points would leave four or five of the cells empty.
    for (const int count : visits) EXPECT_TRUE(count >= 1 && count <= 8);
  }
}

TEST(EvenPoints, ThePointsVisitEveryPartOfAThreeDimensionalBox) {
  Random random(1);
  EvenPoints<3> points({{0, 0, 0}, {1, 1, 1}}, random);
  std::array<int, 64> visits{};
  for (int k = 0; k < 8 * 64; ++k) {
    const Point<3> p = points.next();
    const auto cell = [](double s) { return std::min(3, static_cast<int>(4 * s)); };
    ++visits[static_cast<std::size_t>(16 * cell(p.z()) + 4 * cell(p.y()) + cell(p.x()))];
  }
  for (const int count : visits) EXPECT_GE(count, 2);
}

}  // namespace
}  // namespace coppice
