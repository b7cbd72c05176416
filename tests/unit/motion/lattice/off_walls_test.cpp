// Tests of moving paths away from walls.
#include "motion/lattice/off_walls.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

/// A wall from the left, 10 cells thick, in the middle of the map. `gap`: cells beside its end.
ClearanceField wall(int gap) {
  OccupancyMap map{.width = 50, .height = 50, .blocked = std::vector<std::uint8_t>(2'500, 0)};
  for (int y = 20; y < 30; ++y) {
    for (int x = 0; x < 50 - gap; ++x) map.blocked[static_cast<std::size_t>(y * map.width + x)] = 1;
  }
  return ClearanceField(map);
}

TEST(OffWalls, CornersMoveAsFarAsTheyNeed) {
  const ClearanceField field = wall(20);
  const Path taut{{20, 9}, {32, 18}, {32, 32}, {20, 41}};
  ASSERT_TRUE(field.is_free(taut[1], 2));
  const Path moved = off_walls(taut, field, 2, 2.2);
  EXPECT_EQ(moved.front(), taut.front());
  EXPECT_EQ(moved.back(), taut.back());
  for (const std::size_t k : {1u, 2u}) {
    EXPECT_TRUE(field.is_free(moved[k], 2.2));
    EXPECT_LT((moved[k] - taut[k]).norm(), 0.3);
  }
}

TEST(OffWalls, CornersWithoutRoomStay) {
  const ClearanceField field = wall(4);
  const Path taut{{10, 10}, {48, 18}, {48, 32}, {10, 40}};
  EXPECT_EQ(off_walls(taut, field, 2, 2.2), taut);
}

}  // namespace
}  // namespace coppice
