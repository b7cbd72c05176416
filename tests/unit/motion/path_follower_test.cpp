#include "motion/path_follower.h"

#include <gtest/gtest.h>

#include "coppice/planning/clearance_field.h"

namespace coppice {
namespace {

const OccupancyMap hall{.width = 120, .height = 40, .blocked = std::vector<std::uint8_t>(4800, 0)};

TEST(PathFollower, TheRemainingWayIsMeasuredFromTheRobotsPosition) {
  const ClearanceField field(hall);
  PathFollower follower({{10, 20}, {110, 20}}, 1);
  ASSERT_TRUE(follower.look_from({10, 20}, field, {2, 2}));
  EXPECT_DOUBLE_EQ(follower.way_left({10, 20}), 100);
  EXPECT_DOUBLE_EQ(follower.way_left({70, 23}), 43) << "a joint plan led the robot along its path";
  EXPECT_DOUBLE_EQ(follower.way_left({70, 23}), 43) << "the query does not move the follower";
}

}  // namespace
}  // namespace coppice
