// Tests of the lattice that follows the walls, checked with nothing but the clearance field and distances.
#include "motion/lattice/lattice.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "motion/trajectory/space_time.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

constexpr double odd_radius = 5.3;
constexpr double spacing = 2.5;
constexpr double fine_within = 12.5;

/// A corridor of a width along y, from one end of the map to the other.
OccupancyMap corridor(int left, int width) {
  OccupancyMap map{.width = 100, .height = 200, .blocked = std::vector<std::uint8_t>(100 * 200, 1)};
  for (int j = 0; j < map.height; ++j) {
    for (int i = left; i < left + width; ++i) map.blocked[static_cast<std::size_t>(j * map.width + i)] = 0;
  }
  return map;
}

std::vector<Lattice::Vertex> free_vertices(Lattice& lattice) {
  std::vector<Lattice::Vertex> result;
  for (Lattice::Vertex v = 0; v < lattice.size(); ++v) {
    if (lattice.vertex_free(v)) result.push_back(v);
  }
  return result;
}

/// The vertices that edges lead to from v, over several edges too.
std::vector<Lattice::Vertex> reached_from(Lattice::Vertex v, Lattice& lattice) {
  std::vector<bool> known(lattice.size());
  std::vector<Lattice::Vertex> reached{v};
  known[v] = true;
  for (std::size_t k = 0; k < reached.size(); ++k) {
    lattice.for_each_neighbour(
        reached[k], [&](Lattice::Vertex w) { return !known[w]; },
        [&](Lattice::Vertex w, double) {
          known[w] = true;
          reached.push_back(w);
        });
  }
  return reached;
}

TEST(LatticeOfWalls, LeadsThroughAnAisleThatLiesBetweenTwoRows) {
  for (int left = 30; left < 35; ++left) {
    const ClearanceField field(corridor(left, 12));
    Lattice lattice = Lattice::of_walls(field, field.bounds(), odd_radius, spacing, fine_within);
    const auto free = free_vertices(lattice);
    ASSERT_FALSE(free.empty()) << left;
    double farthest = 0;
    for (const Lattice::Vertex v : reached_from(free.front(), lattice))
      farthest = std::max(farthest, lattice.at(v).y() - lattice.at(free.front()).y());
    EXPECT_GT(farthest, 180) << left;
  }
}

TEST(LatticeOfWalls, HasTwoLanesWhereThereIsRoomForTwo) {
  constexpr int width = 24;
  for (int left = 30; left < 35; ++left) {
    const ClearanceField field(corridor(left, width));
    Lattice lattice = Lattice::of_walls(field, field.bounds(), odd_radius, spacing, fine_within);
    double least = 1000;
    double most = 0;
    for (const Lattice::Vertex v : free_vertices(lattice)) {
      if (std::abs(lattice.at(v).y() - 100) > spacing) continue;
      least = std::min(least, lattice.at(v).x());
      most = std::max(most, lattice.at(v).x());
    }
    EXPECT_GE(most - least, kept_apart(5, 5)) << left;
  }
}

TEST(LatticeOfWalls, NoVertexAndNoEdgeTouchesAnObstacle) {
  Random random(3);
  for (const MapKind kind : {MapKind::room, MapKind::maze, MapKind::dense}) {
    const ClearanceField field(generate_map(kind, 200, 200, random));
    Lattice lattice = Lattice::of_walls(field, field.bounds(), odd_radius, spacing, fine_within);
    std::size_t moved = 0;
    for (const Lattice::Vertex v : free_vertices(lattice)) {
      EXPECT_TRUE(field.is_free(lattice.at(v), odd_radius));
      const Point2 steps = lattice.at(v) / spacing;
      moved += (steps - Point2(std::round(steps.x()), std::round(steps.y()))).norm() > 1e-9;
      lattice.for_each_neighbour(
          v, [](Lattice::Vertex) { return true; },
          [&](Lattice::Vertex w, double length) {
            EXPECT_NEAR(length, (lattice.at(v) - lattice.at(w)).norm(), 1e-9);
            EXPECT_TRUE(field.segment_free(lattice.at(v), lattice.at(w), odd_radius));
          });
    }
    EXPECT_GT(moved, 0u);
  }
}

TEST(LatticeOfWalls, IsCoarseFarFromObstacles) {
  const ClearanceField field(test::open_map(200, 200));
  Lattice lattice = Lattice::of_walls(field, field.bounds(), odd_radius, spacing, fine_within);
  const auto free = free_vertices(lattice);
  const Lattice::Vertex middle = *std::ranges::min_element(
      free, {}, [&](Lattice::Vertex v) { return (lattice.at(v) - Point2(100, 100)).norm(); });
  int neighbours = 0;
  lattice.for_each_neighbour(
      middle, [](Lattice::Vertex) { return true; },
      [&](Lattice::Vertex, double length) {
        ++neighbours;
        EXPECT_GE(length, Lattice::coarsest * spacing);
      });
  EXPECT_EQ(neighbours, 8);
}

TEST(LatticeOfWalls, IsConnectedWhereTheSpacingChanges) {
  const ClearanceField field(test::open_map(100, 100));
  Lattice lattice = Lattice::of_walls(field, field.bounds(), odd_radius, spacing, fine_within);
  const auto free = free_vertices(lattice);
  EXPECT_EQ(reached_from(free.front(), lattice).size(), free.size());
}

TEST(LatticeOfWalls, IsNotFinerThanALargeMapAllows) {
  const ClearanceField field(test::open_map(1000, 1000));
  const Lattice lattice = Lattice::of_walls(field, field.bounds(), 0.37, 0.175, 0.9);
  EXPECT_EQ(lattice.spacing(), 0.5);
}

TEST(LatticeOfWalls, DividesACellForASmallRobot) {
  const ClearanceField field(test::open_map(20, 20));
  EXPECT_NEAR(Lattice::of_walls(field, field.bounds(), 0.37, 0.175, 0.9).spacing(), 1.0 / 6, 1e-12);
  EXPECT_EQ(Lattice(field, 0.37, 0.175).spacing(), 0.5);
}

}  // namespace
}  // namespace coppice
