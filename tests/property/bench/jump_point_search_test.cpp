// Jump point search finds paths as short as those of A* on the same grid, and robots can drive along them.

#include "bench/jump_point_search.h"

#include <gtest/gtest.h>

#include "bench/grid_a_star.h"
#include "coppice/planning/random.h"

namespace coppice {
namespace {

struct Case {
  OccupancyMap map;
  Point2 start;
  Point2 goal;
};

/// A small map with random blocked cells, and two of its cells.
Case random_case(std::uint64_t seed) {
  Random random(seed);
  Case drawn{.map = {.width = 4 + static_cast<int>(random.index(12)),
                     .height = 4 + static_cast<int>(random.index(12)),
                     .blocked = {}},
             .start = {},
             .goal = {}};
  const double share = random.uniform(0, 0.5);
  for (std::size_t k = 0; k < drawn.map.frame().cells(); ++k)
    drawn.map.blocked.push_back(random.uniform() < share);
  const auto centre = [&] {
    const auto i = random.index(static_cast<std::size_t>(drawn.map.width));
    const auto j = random.index(static_cast<std::size_t>(drawn.map.height));
    drawn.map.blocked[j * static_cast<std::size_t>(drawn.map.width) + i] = 0;
    return Point2(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5);
  };
  drawn.start = centre();
  drawn.goal = centre();
  return drawn;
}

TEST(JumpPointSearch, ItsPathsAreAsShortAsThoseOfAStar) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    const Case drawn = random_case(seed);
    const ClearanceField field(drawn.map);
    const Path a_star = GridAStar(field).path(drawn.start, drawn.goal, 0.4);
    const Path jumps = JumpPointSearch(field).path(drawn.start, drawn.goal, 0.4);
    ASSERT_EQ(jumps.empty(), a_star.empty()) << seed;
    ASSERT_NEAR(length_of(jumps), length_of(a_star), 1e-4) << seed;
    found += !jumps.empty() && drawn.start != drawn.goal;
  }
  EXPECT_GT(found, 1000);
}

TEST(JumpPointSearch, ARobotCanDriveAlongThePathsOfBothPlanners) {
  constexpr double radius = 0.35;
  int driven = 0;
  const auto expect_free = [&](const ClearanceField& field, const Path& path) {
    driven += path.size() > 2;
    for (std::size_t k = 1; k < path.size(); ++k)
      ASSERT_TRUE(field.segment_free(path[k - 1], path[k], radius)) << path[k - 1] << path[k];
  };
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    Case drawn = random_case(seed);
    const ClearanceField field(drawn.map);
    Random random(seed);
    const auto moved = [&](const Point2& centre) {
      return Point2(centre + Point2(random.uniform(-0.15, 0.15), random.uniform(-0.15, 0.15)));
    };
    drawn.start = moved(drawn.start);
    drawn.goal = moved(drawn.goal);
    expect_free(field, GridAStar(field).path(drawn.start, drawn.goal, radius));
    expect_free(field, JumpPointSearch(field).path(drawn.start, drawn.goal, radius));
  }
  EXPECT_GT(driven, 600);
}

TEST(JumpPointSearch, ItExpandsFarFewerCells) {
  const OccupancyMap map{.width = 200, .height = 200, .blocked = std::vector<std::uint8_t>(40'000, 0)};
  const ClearanceField field(map);
  GridAStar a_star(field);
  JumpPointSearch jumps(field);
  for (const Point2& goal : {Point2(190.5, 20.5), Point2(150.5, 190.5)}) {
    a_star.path({5.5, 5.5}, goal, 2);
    jumps.path({5.5, 5.5}, goal, 2);
  }
  EXPECT_LT(10 * jumps.expanded(), a_star.expanded());
}

}  // namespace
}  // namespace coppice
