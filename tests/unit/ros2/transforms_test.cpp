// Tests of the frames that a robot is found by.
#include "ros2/transforms.h"

#include <numbers>

#include <gtest/gtest.h>

namespace coppice {
namespace {

using std::numbers::pi;

TEST(Transforms, APoseFollowsFromAllTransformsUpToTheAncestor) {
  Transforms known;
  known.take({"map", "odom", {{10, 0}, pi / 2}}, 0);
  known.take({"odom", "foot", {{2, 1}, 0}}, 0);
  known.take({"foot", "base", {{0.5, 0}, -pi / 2}, true}, -100);
  const auto pose = known.pose_in("map", "base", 0.1);
  ASSERT_TRUE(pose);
  EXPECT_NEAR((pose->position - Point2(9, 2.5)).norm(), 0, 1e-12);
  EXPECT_NEAR(pose->yaw, 0, 1e-12);
  EXPECT_TRUE(known.pose_in("map", "map", 0.1));
}

TEST(Transforms, AMissingOrOldTransformGivesNoPose) {
  Transforms known;
  known.take({"odom", "base", {{1, 2}, 0}}, 5);
  EXPECT_FALSE(known.pose_in("map", "base", 5));
  known.take({"map", "odom", {{0, 0}, 0}}, 4);
  EXPECT_TRUE(known.pose_in("map", "base", 4 + Transforms::longest_age));
  EXPECT_FALSE(known.pose_in("map", "base", 5)) << "the localisation is silent";
  known.take({"map", "odom", {{0, 0}, 0}}, 5);
  EXPECT_TRUE(known.pose_in("map", "base", 5));
}

TEST(Transforms, ACircleOfFramesEnds) {
  Transforms known;
  known.take({"a", "b", {}}, 0);
  known.take({"b", "a", {}}, 0);
  EXPECT_FALSE(known.pose_in("map", "a", 0));
}

}  // namespace
}  // namespace coppice
