// Tests of the clearance field against brute force over all cells, on random maps.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/random.h"

namespace coppice {
namespace {

// Nearer than this to touching, rounding may decide either way.
constexpr double band = 1e-6;

/// A map of blocks, walls and single cells, which independent random cells would never give.
OccupancyMap map_of_blocks(Random& random) {
  OccupancyMap map;
  map.width = 1 + static_cast<int>(random.index(40));
  map.height = 1 + static_cast<int>(random.index(40));
  map.resolution = random.uniform() < 0.5 ? 1.0 : random.uniform(0.02, 3);
  if (random.uniform() < 0.5) map.origin = Point2(random.uniform(-100, 100), random.uniform(-100, 100));
  map.blocked.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), 0);
  for (std::size_t n = random.index(12); n > 0; --n) {
    const int i = static_cast<int>(random.index(static_cast<std::size_t>(map.width)));
    const int j = static_cast<int>(random.index(static_cast<std::size_t>(map.height)));
    const int wide = static_cast<int>(random.index(random.uniform() < 0.5 ? 2 : 12));
    const int high = static_cast<int>(random.index(random.uniform() < 0.5 ? 2 : 12));
    for (int y = j; y <= std::min(j + high, map.height - 1); ++y) {
      for (int x = i; x <= std::min(i + wide, map.width - 1); ++x) {
        map.blocked[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                    static_cast<std::size_t>(x)] = 1;
      }
    }
  }
  return map;
}

Point2 random_point(const Box<2>& box, Random& random) {
  return {random.uniform(box.lower.x(), box.upper.x()), random.uniform(box.lower.y(), box.upper.y())};
}

double point_to_square(const Point2& p, const Box<2>& square) {
  return (p - p.cwiseMax(square.lower).cwiseMin(square.upper)).norm();
}

/// The least distance of the segment to a square. It is convex in the position on the segment, so that
/// ternary search finds it.
double segment_to_square(const Point2& a, const Point2& b, const Box<2>& square) {
  double lower = 0;
  double upper = 1;
  for (int n = 0; n < 100; ++n) {
    const double t = (2 * lower + upper) / 3;
    const double u = (lower + 2 * upper) / 3;
    if (point_to_square(a + t * (b - a), square) <= point_to_square(a + u * (b - a), square)) {
      upper = u;
    } else {
      lower = t;
    }
  }
  return point_to_square(a + lower * (b - a), square);
}

double true_clearance(const OccupancyMap& map, const Point2& a, const Point2& b) {
  const Box<2> box = map.bounds();
  double least = std::min({(a - box.lower).minCoeff(), (b - box.lower).minCoeff(), (box.upper - a).minCoeff(),
                           (box.upper - b).minCoeff()});
  for (int j = 0; j < map.height; ++j) {
    for (int i = 0; i < map.width; ++i) {
      if (!map.is_blocked(i, j)) continue;
      const Box<2> square{map.origin + map.resolution * Point2(i, j),
                          map.origin + map.resolution * Point2(i + 1, j + 1)};
      least = std::min(least, segment_to_square(a, b, square));
    }
  }
  return std::max(least, 0.0);
}

RC_GTEST_PROP(ClearanceField, AnswersAtPointsAgreeWithBruteForce, (std::uint64_t seed)) {
  Random random(seed);
  const OccupancyMap map = map_of_blocks(random);
  const ClearanceField field(map);
  for (int n = 0; n < 30; ++n) {
    const Point2 p = random_point(field.bounds(), random);
    const double truth = true_clearance(map, p, p);
    RC_ASSERT(field.lower_bound(p) <= truth + 1e-12);
    RC_ASSERT(std::abs(field.clearance(p) - truth) <= 1e-9);
    const double radius = random.uniform() < 0.5 ? truth + random.uniform(-0.1, 0.1) : random.uniform(0, 5);
    if (radius >= 0 && std::abs(truth - radius) > band)
      RC_ASSERT(field.is_free(p, radius) == (truth > radius));
  }
}

RC_GTEST_PROP(ClearanceField, AnswersOnSegmentsAgreeWithBruteForce, (std::uint64_t seed)) {
  Random random(seed);
  const OccupancyMap map = map_of_blocks(random);
  const ClearanceField field(map);
  for (int n = 0; n < 10; ++n) {
    const Point2 a = random_point(field.bounds(), random);
    const Point2 b = random_point(field.bounds(), random);
    const double truth = true_clearance(map, a, b);
    RC_ASSERT(std::abs(field.segment_clearance(a, b) - truth) <= 1e-9);
    const double radius = random.uniform() < 0.5 ? truth + random.uniform(-0.1, 0.1) : random.uniform(0, 5);
    if (radius >= 0 && std::abs(truth - radius) > band) {
      RC_ASSERT(field.segment_free(a, b, radius) == (truth > radius));
    }
  }
}

// The bound must be near the exact value: in open space, within a quarter of a cell.
RC_GTEST_PROP(ClearanceField, TheLowerBoundIsCloseBesideOneObstacle, (std::uint64_t seed)) {
  Random random(seed);
  OccupancyMap map;
  map.width = map.height = 101;
  map.blocked.assign(10201, 0);
  map.blocked[5100] = 1;  // the cell in the middle
  const ClearanceField field(map);
  const Point2 p(random.uniform(30, 71), random.uniform(30, 71));
  const double truth = true_clearance(map, p, p);
  RC_PRE(truth > 1);
  RC_ASSERT(field.lower_bound(p) >= std::sqrt(truth * truth - 0.5));
}

}  // namespace
}  // namespace coppice
