#include "coppice/planning/map_generator.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "planning/geometry/reachability.h"

namespace coppice {
namespace {

/// The columns or the rows of a map.
struct Side {
  const OccupancyMap& map;
  bool upright;

  int length() const { return upright ? map.width : map.height; }
  bool is_solid(int k) const {
    const int across = upright ? map.height : map.width;
    for (int i = 0; i < across; ++i) {
      if (upright ? !map.is_blocked(k, i) : !map.is_blocked(i, k)) return false;
    }
    return true;
  }
  /// The number of solid lines at the beginning.
  int margin_before() const {
    int count = 0;
    while (count < length() && is_solid(count)) ++count;
    return count;
  }
  int margin_behind() const {
    int count = 0;
    while (count < length() && is_solid(length() - 1 - count)) ++count;
    return count;
  }
};

TEST(MapGenerator, RoomsAndMazesFillTheMap) {
  Random random(3);
  for (const MapKind kind : {MapKind::room, MapKind::maze}) {
    for (const int width : {68, 69, 100, 131, 300, 452, 511, 512, 1000}) {
      for (const int height : {68, 127, 200, 512}) {
        const OccupancyMap map = generate_map(kind, width, height, random);
        for (const bool upright : {true, false}) {
          const Side side{map, upright};
          EXPECT_EQ(side.margin_before(), 4) << width << " x " << height;
          EXPECT_EQ(side.margin_behind(), 4) << width << " x " << height;
        }
      }
    }
  }
}

TEST(MapGenerator, RobotsThatFitACorridorReachAllOfTheMap) {
  Random random(4);
  for (const int side : {68, 150, 333, 512}) {
    for (const auto& [kind, radius] : {std::pair(MapKind::room, 9.5), std::pair(MapKind::maze, 11.5)}) {
      const OccupancyMap map = generate_map(kind, side, side, random);
      const ClearanceField field(map);
      std::size_t fits = 0;
      for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) fits += field.is_free({i + 0.5, j + 0.5}, radius);
      }
      EXPECT_GT(fits, 0u);
      EXPECT_EQ(ReachablePart::largest(field, radius).size(), fits) << side;
    }
  }
}

}  // namespace
}  // namespace coppice
