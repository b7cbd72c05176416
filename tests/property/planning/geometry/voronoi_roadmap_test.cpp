// Tests on small random maps with radii that fit exactly. A path is found if there is one, also through
// passages as wide as the robot. Otherwise it is proved that there is none.

#include "planning/geometry/voronoi_roadmap.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "planning/geometry/free_way.h"
#include "planning/trees/fleet_plan.h"

namespace coppice {
namespace {

OccupancyMap map_of_cells(Random& random) {
  OccupancyMap map;
  map.width = 3 + static_cast<int>(random.index(10));
  map.height = 3 + static_cast<int>(random.index(10));
  const double share = random.uniform(0.05, 0.4);
  for (int k = 0; k < map.width * map.height; ++k) map.blocked.push_back(random.uniform() < share);
  const std::array resolutions{1.0, 0.05, 0.1, 0.3, 7.0};
  const std::array origins{Point2(0, 0), Point2(-1.5, 2), Point2(447000, 4649776)};
  map.resolution = resolutions[random.index(resolutions.size())];
  map.origin = origins[random.index(origins.size())];
  return map;
}

/// Positions half a cell apart, joined where the disc is free on the straight line. A path on this lattice
/// exists.
class Lattice {
 public:
  Lattice(const ClearanceField& field, double radius)
      : field_(field), radius_(radius), columns_(2 * field.frame().width + 1) {
    for (int k = 0; k < columns_ * (2 * field.frame().height + 1); ++k) {
      if (field.is_free(place(k), radius)) free_.push_back(k);
    }
  }

  const std::vector<int>& free_places() const { return free_; }
  Point2 place(int k) const {
    const GridFrame& frame = field_.frame();
    return frame.origin + frame.resolution * 0.5 * Point2(k % columns_, k / columns_);
  }

  /// A random point from which the disc can go straight to a lattice position.
  Point2 point_near(int k, Random& random) const {
    for (int tries = 0; tries < 20; ++tries) {
      const Point2 offset(random.uniform(-1, 1), random.uniform(-1, 1));
      const Point2 p = place(k) + field_.frame().resolution * offset;
      if (field_.segment_free(p, place(k), radius_)) return p;
    }
    return place(k);
  }

  bool joins(int start, int goal) const {
    std::vector<int> open{start};
    std::vector<bool> seen(static_cast<std::size_t>(columns_ * (2 * field_.frame().height + 1)));
    while (!open.empty()) {
      const int here = open.back();
      open.pop_back();
      if (here == goal) return true;
      for (const int there : free_) {
        if (seen[static_cast<std::size_t>(there)] ||
            (place(there) - place(here)).norm() > 1.6 * field_.frame().resolution ||
            !field_.segment_free(place(here), place(there), radius_))
          continue;
        seen[static_cast<std::size_t>(there)] = true;
        open.push_back(there);
      }
    }
    return false;
  }

 private:
  const ClearanceField& field_;
  double radius_;
  int columns_;
  std::vector<int> free_;
};

double fitting_radius(const OccupancyMap& map, Random& random) {
  // Half a cell, a cell, ...; half of the gap between corners that touch at a knight's move; or any value.
  const std::array fits{0.5, 1.0, 1.5, 0.5 * std::sqrt(2.0), 0.5 * std::sqrt(5.0), random.uniform(0.1, 2.0)};
  return map.resolution * fits[random.index(fits.size())];
}

void expect_free(const ClearanceField& field, const Path& way, double radius) {
  for (std::size_t i = 1; i < way.size(); ++i)
    ASSERT_TRUE(field.segment_free(way[i - 1], way[i], radius)) << "segment " << i;
}

TEST(VoronoiRoadmap, EveryPathThatALatticeFindsIsFound) {
  Random random(1);
  int found = 0;
  int proved = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const OccupancyMap map = map_of_cells(random);
    const ClearanceField field(map);
    const double radius = fitting_radius(map, random);
    const Lattice lattice(field, radius);
    if (lattice.free_places().size() < 2) continue;
    const VoronoiRoadmap roadmap(field);
    for (int pair = 0; pair < 4; ++pair) {
      const int from = lattice.free_places()[random.index(lattice.free_places().size())];
      const int to = lattice.free_places()[random.index(lattice.free_places().size())];
      const Point2 start = pair % 2 == 0 ? lattice.place(from) : lattice.point_near(from, random);
      const Point2 goal = pair % 2 == 0 ? lattice.place(to) : lattice.point_near(to, random);
      const auto way = roadmap.way(start, goal, radius);
      ASSERT_TRUE(way || !lattice.joins(from, to))
          << "trial " << trial << " radius " << radius << " cell " << map.resolution;
      found += way.has_value();
      proved += !way;
      if (!way) continue;
      EXPECT_EQ(way->front(), start);
      EXPECT_EQ(way->back(), goal);
      expect_free(field, *way, radius);
    }
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(proved, 300);
}

/// Two rooms with a door of `door` cells between them, rotated and mirrored.
OccupancyMap rooms_with_a_door(int door, bool upright, bool mirrored) {
  OccupancyMap map{
      .width = 41, .height = 41, .resolution = 0.05, .blocked = std::vector<std::uint8_t>(41 * 41)};
  for (int k = 0; k < 41; ++k) {
    const int along = mirrored ? 40 - k : k;
    const bool open = along >= 9 && along < 9 + door;
    map.blocked[static_cast<std::size_t>(upright ? k * 41 + 20 : 20 * 41 + k)] = !open;
  }
  return map;
}

TEST(VoronoiRoadmap, ADoorAsWideAsTheRobotIsPassedAndANarrowerOneIsNot) {
  for (const Point2& origin : {Point2(0, 0), Point2(-13.37, 4.2), Point2(447000, 4649776)}) {
    for (const int door : {1, 5, 10}) {
      for (const int turn : {0, 1, 2, 3}) {
        OccupancyMap map = rooms_with_a_door(door, turn % 2 == 0, turn / 2 == 0);
        map.origin = origin;
        const ClearanceField field(map);
        const VoronoiRoadmap roadmap(field);
        const Point2 start = origin + Point2(0.4, 0.4);
        const Point2 goal = origin + Point2(1.7, 1.6);
        const double radius = door * 0.05 / 2;
        EXPECT_TRUE(roadmap.way(start, goal, radius)) << "door " << door << " turn " << turn;
        EXPECT_TRUE(roadmap.way(start, goal, radius - 1e-3)) << "door " << door << " turn " << turn;
        EXPECT_FALSE(roadmap.way(start, goal, radius + 1e-6)) << "door " << door << " turn " << turn;
      }
    }
  }
}

TEST(VoronoiRoadmap, ADiscThatRoundingBroughtIntoAWallOfItsPocketFindsItsWayOut) {
  OccupancyMap map{.width = 9, .height = 5, .resolution = 1, .blocked = std::vector<std::uint8_t>(45)};
  for (std::size_t column = 0; column < 6; ++column) {
    for (const std::size_t row : {0, 1, 3, 4}) map.blocked[row * 9 + column] = 1;
  }
  const ClearanceField field(map);
  const VoronoiRoadmap roadmap(field);
  const Point2 goal(7.5, 1.5);
  for (const double rounding : {0.5, -0.5})
    EXPECT_TRUE(roadmap.way({1.5, 2.5 + rounding * driving_rounding}, goal, 0.5)) << rounding;
  EXPECT_FALSE(roadmap.way({1.5, 2.5 + 2 * driving_rounding}, goal, 0.5));
}

TEST(VoronoiRoadmap, AClosedWallIsProvedToBeClosed) {
  const ClearanceField field(rooms_with_a_door(0, true, false));
  EXPECT_FALSE(VoronoiRoadmap(field).way({0.4, 0.4}, {1.7, 1.6}, 0.05));
  EXPECT_TRUE(VoronoiRoadmap(field).way({0.4, 0.4}, {0.5, 1.6}, 0.05));
}

TEST(FleetPlan, EverySearchOnASmallMapEndsAndAgreesWithTheRoadmap) {
  Random random(2);
  for (int trial = 0; trial < 10; ++trial) {
    const OccupancyMap map = map_of_cells(random);
    const ClearanceField field(map);
    const double radius = fitting_radius(map, random);
    const Lattice lattice(field, radius);
    if (lattice.free_places().size() < 2) continue;
    const Point2 start = lattice.place(lattice.free_places()[random.index(lattice.free_places().size())]);
    const Point2 goal = lattice.place(lattice.free_places()[random.index(lattice.free_places().size())]);
    const std::array problems{PlanningProblem{start, goal, radius}};
    FleetPlanner planner(field, problems, {}, Random(7));
    int searches = 0;
    while (planner.search()) ASSERT_LT(++searches, 2000) << "trial " << trial;
    planner.take_first_paths();
    for (int steps = 0; planner.improve(); ++steps) ASSERT_LT(steps, 100'000) << "trial " << trial;
    EXPECT_EQ(planner.path(0).empty(), !VoronoiRoadmap(field).way(start, goal, radius)) << "trial " << trial;
    EXPECT_EQ(planner.path(0).empty(), !planner.reason(0).empty());
    expect_free(field, planner.path(0), radius);
  }
}

}  // namespace
}  // namespace coppice
