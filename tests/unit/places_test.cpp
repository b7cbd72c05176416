// Where a crowd can stand, checked with nothing but the clearance field and distances.
#include "motion/places.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "planning/map_generator.h"

namespace coppice {
namespace {

constexpr double radius = 5;
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

TEST(Places, RobotsOnAllOfThemTouchNothing) {
  const ClearanceField field(rooms());
  const PlaceGraph graph = PackedPlaces(field, radius, 1).with({}, {});
  ASSERT_GT(graph.places.size(), 100u);
  for (std::size_t a = 0; a < graph.places.size(); ++a) {
    EXPECT_TRUE(field.is_free(graph.places[a], radius));
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_GE((graph.places[a] - graph.places[b]).norm(), touching - 1e-9);
  }
}

TEST(Places, EdgesAreFreeAndKnowWhoIsNear) {
  const ClearanceField field(rooms());
  const std::vector<Point2> more{{40.3, 40.7}, {51.2, 44.9}};
  for (const Point2& p : more) ASSERT_TRUE(field.is_free(p, radius));
  const PlaceGraph graph = PackedPlaces(field, radius, 1).with(more, {});
  for (Place from = 0; from < graph.places.size(); ++from) {
    for (const PlaceGraph::Edge& edge : graph.edges[from]) {
      EXPECT_EQ(edge.path.front(), graph.places[from]);
      EXPECT_EQ(edge.path.back(), graph.places[edge.to]);
      for (std::size_t k = 1; k < edge.path.size(); ++k)
        EXPECT_TRUE(field.segment_free(edge.path[k - 1], edge.path[k], radius));
      for (Place k = 0; k < graph.places.size(); ++k) {
        const bool touches = point_path_distance(graph.places[k], edge.path) < touching - 1e-6;
        // Who stands at the edge's beginning has nobody that near already.
        const bool alone = (graph.places[k] - graph.places[from]).norm() < touching - 1e-6;
        const bool known = std::ranges::binary_search(edge.near, k);
        EXPECT_TRUE(!touches || alone || known) << from << " " << k;
      }
    }
  }
}

TEST(Places, OneConnectedFreeSpaceIsOnePart) {
  for (const int width : {10, 14, 24, 40}) {
    const ClearanceField field(corridor(width));
    const std::vector<Place> parts = parts_of(PackedPlaces(field, radius, 1).with({}, {}));
    EXPECT_EQ(std::ranges::count(parts, parts.front()), static_cast<std::ptrdiff_t>(parts.size())) << width;
  }
}

TEST(Places, AWideCorridorGetsTwoLanes) {
  const ClearanceField narrow(corridor(14));
  const ClearanceField wide(corridor(24));
  const std::size_t one_lane = PackedPlaces(narrow, radius, 1).with({}, {}).places.size();
  const std::size_t two_lanes = PackedPlaces(wide, radius, 1).with({}, {}).places.size();
  EXPECT_NEAR(static_cast<double>(one_lane), 190 / 10.5, 2);
  EXPECT_NEAR(static_cast<double>(two_lanes), 2 * 190 / 10.5, 4);
}

TEST(Places, NoEdgeLeadsThroughWhatStandsForEver) {
  const ClearanceField field(corridor(14));
  const std::vector<Disc> dead{{{100, 50}, radius}};
  const std::vector<Point2> more{{20, 50}, {180, 50}};
  const PlaceGraph graph = PackedPlaces(field, radius, 1).with(more, dead);
  const std::vector<Place> parts = parts_of(graph);
  EXPECT_NE(parts[0], parts[1]);
}

// A wall of one cell: robots stand on both sides of it, closer to each other than packed places are.
TEST(Places, AThinWallHasPlacesOnBothSides) {
  OccupancyMap map = corridor(21);
  for (int i = 0; i < 200; ++i) map.blocked[static_cast<std::size_t>(50 * 200 + i)] = 1;
  const ClearanceField field(map);
  const PlaceGraph graph = PackedPlaces(field, radius, 1).with({}, {});
  const auto below = std::ranges::count_if(graph.places, [](const Point2& p) { return p.y() < 50; });
  const auto above = std::ranges::count_if(graph.places, [](const Point2& p) { return p.y() > 51; });
  EXPECT_GT(below, 15);
  EXPECT_GT(above, 15);
}

}  // namespace
}  // namespace coppice
