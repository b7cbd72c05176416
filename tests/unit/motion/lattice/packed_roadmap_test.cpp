// Tests of where a cluster can stand, checked with nothing but the clearance field and distances.
#include "motion/lattice/packed_roadmap.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "motion/lattice/cost_to_go.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::radius;
constexpr double touching = 2 * radius + standing_gap;

OccupancyMap corridor(int width) {
  OccupancyMap map{.width = 200, .height = 100, .blocked = std::vector<std::uint8_t>(200 * 100, 1)};
  for (int j = 50 - width / 2; j < 50 - width / 2 + width; ++j) {
    for (int i = 0; i < 200; ++i) map.blocked[static_cast<std::size_t>(j * 200 + i)] = 0;
  }
  return map;
}

OccupancyMap rooms() {
  Random random(2);
  return generate_map(MapKind::room, 300, 300, random);
}

TEST(PackedRoadmap, RobotsOnAllVerticesTouchNothing) {
  const ClearanceField field(rooms());
  PackedRoadmap packed(field, radius, 1);
  const AnnotatedRoadmap graph = packed.with({}, {});
  ASSERT_GT(graph.size(), 100u);
  for (Vertex a = 0; a < graph.size(); ++a) {
    EXPECT_TRUE(field.is_free(graph.at(a), radius));
    for (Vertex b = 0; b < a; ++b) EXPECT_GE((graph.at(a) - graph.at(b)).norm(), touching - 1e-9);
  }
}

TEST(PackedRoadmap, EdgesAreFreeAndListTheVerticesNearThem) {
  const ClearanceField field(rooms());
  const std::vector<Point2> more{{40.3, 40.7}, {51.2, 44.9}};
  for (const Point2& p : more) ASSERT_TRUE(field.is_free(p, radius));
  PackedRoadmap packed(field, radius, 1);
  const AnnotatedRoadmap graph = packed.with(more, {});
  for (Vertex from = 0; from < graph.size(); ++from) {
    for (const AnnotatedRoadmap::Edge& edge : graph.edges(from)) {
      EXPECT_EQ(edge.path.front(), graph.at(from));
      EXPECT_EQ(edge.path.back(), graph.at(edge.to));
      for (std::size_t k = 1; k < edge.path.size(); ++k)
        EXPECT_TRUE(field.segment_free(edge.path[k - 1], edge.path[k], radius));
      for (Vertex k = 0; k < graph.size(); ++k) {
        const bool touches = point_path_distance(graph.at(k), edge.path) < touching - 1e-6;
        // A robot at the beginning of the edge already excludes every other robot that near.
        const bool alone = (graph.at(k) - graph.at(from)).norm() < touching - 1e-6;
        const bool known = std::ranges::binary_search(edge.near, k);
        EXPECT_TRUE(!touches || alone || known) << from << " " << k;
      }
    }
  }
}

// A cluster changes only its own graph. The next one finds the packed vertices unchanged.
TEST(PackedRoadmap, AGraphLeavesThePackedVerticesUnchanged) {
  const ClearanceField field(rooms());
  PackedRoadmap packed(field, radius, 1);
  const AnnotatedRoadmap before = packed.with({}, {});
  const std::vector<Point2> more{{40.3, 40.7}, {51.2, 44.9}};
  const std::vector<Disc> failed{{before.at(7), radius}, {before.at(40), 4 * radius}};
  const AnnotatedRoadmap changed = packed.with(more, failed);
  ASSERT_EQ(changed.size(), before.size() + more.size());
  EXPECT_TRUE(changed.edges(7).empty());
  const AnnotatedRoadmap after = packed.with({}, {});
  ASSERT_EQ(after.size(), before.size());
  for (Vertex k = 0; k < before.size(); ++k) {
    ASSERT_EQ(after.edges(k).size(), before.edges(k).size());
    for (std::size_t e = 0; e < before.edges(k).size(); ++e)
      EXPECT_EQ(after.edges(k)[e].near, before.edges(k)[e].near);
  }
}

TEST(PackedRoadmap, EdgesKeepClearOfFailedRobotsOfAnySize) {
  const ClearanceField field(rooms());
  PackedRoadmap packed(field, radius, 1);
  const std::vector<Point2> more{{40.3, 40.7}, {51.2, 44.9}};
  for (const double size : {2.0, 5.0, 40.0}) {
    const std::vector<Disc> failed{{{60, 52}, size}, {{200, 150}, size}};
    const AnnotatedRoadmap graph = packed.with(more, failed);
    for (Vertex from = 0; from < graph.size(); ++from) {
      for (const AnnotatedRoadmap::Edge& edge : graph.edges(from)) {
        for (const Disc& disc : failed)
          EXPECT_GE(point_path_distance(disc.centre, edge.path), radius + size + standing_gap);
      }
    }
  }
}

TEST(PackedRoadmap, AConnectedFreeSpaceGivesAConnectedRoadmap) {
  for (const int width : {10, 14, 24, 40}) {
    const ClearanceField field(corridor(width));
    PackedRoadmap packed(field, radius, 1);
    const AnnotatedRoadmap graph = packed.with({}, {});
    const std::vector<Vertex> numbers = numbers_by_neighbourhood(graph);
    CostToGo cost(graph, numbers, 0, 0);
    for (Vertex k = 0; k < graph.size(); ++k) EXPECT_TRUE(std::isfinite(cost.from(k))) << width;
  }
}

TEST(PackedRoadmap, AWideCorridorGetsTwoLanes) {
  const ClearanceField narrow(corridor(14));
  const ClearanceField wide(corridor(24));
  const std::size_t one_lane = PackedRoadmap(narrow, radius, 1).size();
  const std::size_t two_lanes = PackedRoadmap(wide, radius, 1).size();
  EXPECT_NEAR(static_cast<double>(one_lane), 190 / 10.5, 2);
  EXPECT_NEAR(static_cast<double>(two_lanes), 2 * 190 / 10.5, 4);
}

TEST(PackedRoadmap, TheLeftOneOfTwoLanesCostsMore) {
  const ClearanceField field(corridor(24));
  PackedRoadmap packed(field, radius, 1);
  const AnnotatedRoadmap graph = packed.with({}, {});
  int along_lanes = 0;
  for (Vertex from = 0; from < graph.size(); ++from) {
    for (const AnnotatedRoadmap::Edge& edge : graph.edges(from)) {
      const Point2 way = graph.at(edge.to) - graph.at(from);
      if (std::abs(way.y()) > 1) continue;
      ++along_lanes;
      const bool back_is_to_the_left = (way.x() > 0) == (graph.at(from).y() < 50);
      EXPECT_EQ(edge.cost_back > 1, back_is_to_the_left);
    }
  }
  EXPECT_GT(along_lanes, 50);
}

TEST(PackedRoadmap, ASingleLaneCostsTheSameBothWays) {
  const ClearanceField field(corridor(14));
  PackedRoadmap packed(field, radius, 1);
  const AnnotatedRoadmap graph = packed.with({}, {});
  for (Vertex from = 0; from < graph.size(); ++from) {
    for (const AnnotatedRoadmap::Edge& edge : graph.edges(from)) EXPECT_EQ(edge.cost_back, 1);
  }
}

TEST(PackedRoadmap, NoEdgeLeadsThroughAFailedRobot) {
  const ClearanceField field(corridor(14));
  const std::vector<Disc> failed{{{100, 50}, radius}};
  const std::vector<Point2> more{{20, 50}, {180, 50}};
  PackedRoadmap packed(field, radius, 1);
  const AnnotatedRoadmap graph = packed.with(more, failed);
  const auto first = static_cast<Vertex>(packed.size());
  const std::vector<Vertex> numbers = numbers_by_neighbourhood(graph);
  EXPECT_FALSE(std::isfinite(CostToGo(graph, numbers, first, first + 1).from(first + 1)));
}

// A wall of one cell: robots stand on both sides of it, closer to each other than packed vertices are.
TEST(PackedRoadmap, AThinWallHasVerticesOnBothSides) {
  OccupancyMap map = corridor(21);
  for (std::size_t i = 0; i < 200; ++i) map.blocked[50 * 200 + i] = 1;
  const ClearanceField field(map);
  PackedRoadmap packed(field, radius, 1);
  const AnnotatedRoadmap graph = packed.with({}, {});
  int below = 0;
  int above = 0;
  for (Vertex k = 0; k < graph.size(); ++k) {
    below += graph.at(k).y() < 50;
    above += graph.at(k).y() > 51;
  }
  EXPECT_GT(below, 15);
  EXPECT_GT(above, 15);
}

}  // namespace
}  // namespace coppice
