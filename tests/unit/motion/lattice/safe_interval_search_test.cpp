// Tests of the search for a trajectory past those of others.
#include "motion/lattice/safe_interval_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "planning/geometry/voronoi_roadmap.h"
#include "tests/unit/motion/plans.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::radius;
constexpr double speed = 20;
constexpr Limits limits{speed, 40};

struct World {
  explicit World(const OccupancyMap& map)
      : field(map),
        lattice(field, (1 + reserved_stray_radii) * radius, radius),
        taken(field.bounds(), radius) {}
  std::optional<Trajectory> search(const Path& path, double begin = 0) {
    return SafeIntervalSearch(field, lattice, radius, path).search(taken, begin, limits);
  }
  ClearanceField field;
  Lattice lattice;
  SpaceTime taken;
};

TEST(SafeIntervalSearch, ARobotAloneDrivesStraightAtFullSpeed) {
  World world(test::open_map(200, 100));
  const auto found = world.search({{20, 50}, {180, 73}}, 3);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->front(), (TimedPoint{3, {20, 50}}));
  EXPECT_EQ(found->back().position, Point2(180, 73));
  EXPECT_NEAR(found->back().time, 3 + std::hypot(160, 23) / speed, 0.05);
}

TEST(SafeIntervalSearch, ARobotWaitsUntilTheGoalIsFreeForGood) {
  World world(test::open_map(200, 100));
  // The other stands on the goal for a while, leaves, and comes back once more.
  world.taken.add({{0, {180, 50}},
                   {6, {180, 50}},
                   {8, {180, 10}},
                   {12, {180, 10}},
                   {14, {180, 50}},
                   {16, {180, 50}},
                   {18, {180, 90}}},
                  radius);
  const auto found = world.search({{20, 50}, {180, 50}});
  ASSERT_TRUE(found);
  EXPECT_GT(found->back().time, 16);
}

TEST(SafeIntervalSearch, NothingIsFoundWhereAnotherStandsOnTheGoalForGood) {
  World world(test::open_map(200, 100));
  world.taken.add_standing({180, 50}, radius, SpaceTime::forever);
  EXPECT_FALSE(world.search({{20, 50}, {180, 50}}));
}

TEST(SafeIntervalSearch, ARobotEvadesIntoANicheUntilAnotherHasPassed) {
  OccupancyMap map = test::open_map(200, 60);
  test::block(map, 0, 0, 200, 24);
  test::block(map, 0, 36, 200, 60);
  test::block(map, 0, 10, 40, 24, false);    // where the other one ends
  test::block(map, 88, 36, 104, 54, false);  // the niche
  World world(map);
  world.taken.add({{0, {190, 30}}, {9, {10, 30}}, {10, {10, 16}}}, radius);
  const auto found = world.search({{60, 30}, {180, 30}});
  ASSERT_TRUE(found);
  const bool evades = std::ranges::any_of(*found, [](const TimedPoint& p) { return p.position.y() > 41; });
  EXPECT_TRUE(evades);
}

TEST(SafeIntervalSearch, APassageAsWideAsTheRobotIsFoundByItsPath) {
  OccupancyMap map = test::open_map(200, 100);
  test::block(map, 90, 0, 110, 43);
  test::block(map, 90, 53, 110, 100);  // a door of 10 cells, off the lattice
  World world(map);
  const auto path = VoronoiRoadmap(world.field).way({20, 20}, {180, 80}, radius);
  ASSERT_TRUE(path);
  const auto found = world.search(*path);
  ASSERT_TRUE(found);
  for (std::size_t k = 1; k < found->size(); ++k)
    EXPECT_TRUE(world.field.segment_free((*found)[k - 1].position, (*found)[k].position, radius));
}

TEST(SafeIntervalSearch, APathMayNameAPointTwice) {
  OccupancyMap map = test::open_map(200, 100);
  test::block(map, 40, 0, 160, 43);
  test::block(map, 40, 53, 160, 100);  // a corridor of 10 cells, off the lattice
  World world(map);
  const auto found = world.search({{20, 48}, {20, 48}, {100, 48}, {100, 48}, {180, 48}, {180, 48}});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->back().time, 160 / speed, 0.1);
}

TEST(SafeIntervalSearch, ARobotAtItsGoalStaysThere) {
  OccupancyMap map = test::open_map(200, 100);
  test::block(map, 0, 0, 200, 43);
  World world(map);
  const Point2 beside_the_wall{50, 48.1};  // closer than the lattice goes
  const auto found = world.search({beside_the_wall, beside_the_wall}, 3);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->back(), (TimedPoint{3, beside_the_wall}));
}

}  // namespace
}  // namespace coppice
