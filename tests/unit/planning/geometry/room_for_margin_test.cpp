// Tests of whether robots go wherever they go without a margin.
#include "planning/geometry/room_for_margin.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

/// Two rooms of 40 x 40 cells with a wall between them that is 4 thick, and a way through that is as wide as
/// `gap` says; behind the second one a bay of 12 x 12.
OccupancyMap two_rooms(int gap, int bay = 0) {
  OccupancyMap map{.width = 100, .height = 40};
  map.blocked.assign(100 * 40, 0);
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 100; ++i) {
      const bool wall = i >= 40 && i < 44 && (j < 20 - gap / 2 || j >= 20 - gap / 2 + gap);
      const bool behind = i >= 84 && (j < 20 - bay / 2 || j >= 20 - bay / 2 + bay || i >= 97);
      map.blocked[static_cast<std::size_t>(j) * 100 + static_cast<std::size_t>(i)] = wall || behind ? 1 : 0;
    }
  }
  return map;
}

bool has_room(const OccupancyMap& map, double radius, double margin) {
  return leaves_all_passages(ClearanceField(map), radius, margin, std::vector<Point2>{{20, 20}, {60, 20}});
}

TEST(RoomForMargin, APassageMayNotClose) {
  EXPECT_TRUE(has_room(two_rooms(13), 5, 1));
  EXPECT_FALSE(has_room(two_rooms(11), 5, 1));
  EXPECT_TRUE(has_room(two_rooms(11), 5, 0.5));
  EXPECT_TRUE(has_room(two_rooms(9), 5, 1)) << "no robot passes there anyway, and each stays in its room";
}

TEST(RoomForMargin, ABayMayNotClose) {
  EXPECT_TRUE(has_room(two_rooms(20, 13), 5, 1));
  EXPECT_FALSE(has_room(two_rooms(20, 11), 5, 1)) << "robots let others pass there";
}

TEST(RoomForMargin, AWayAroundAnObstacleMayNotClose) {
  OccupancyMap map{.width = 60, .height = 60};
  map.blocked.assign(60 * 60, 0);
  const auto block = [&](int from, int until) {
    for (int j = from; j < until; ++j)
      for (int i = 25; i < 35; ++i)
        map.blocked[static_cast<std::size_t>(j) * 60 + static_cast<std::size_t>(i)] = 1;
  };
  block(13, 40);
  EXPECT_TRUE(has_room(map, 5, 1));
  block(11, 13);  // 11 cells are left between the obstacle and the border
  EXPECT_FALSE(has_room(map, 5, 1));
}

TEST(RoomForMargin, PartsWithoutRobotsDoNotCount) {
  OccupancyMap map = two_rooms(0, 11);  // no way between the rooms
  const ClearanceField field(map);
  EXPECT_TRUE(leaves_all_passages(field, 5, 1, std::vector<Point2>{{20, 20}}));
  EXPECT_FALSE(leaves_all_passages(field, 5, 1, std::vector<Point2>{{60, 20}}));
}

}  // namespace
}  // namespace coppice
