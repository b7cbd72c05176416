#include "motion/body/keep_right.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

Neighbour neighbour(const Point2& position, const Point2& velocity) {
  return {{.position = position, .velocity = velocity, .next_velocity = velocity}, 5, {20, 40}, false};
}

TEST(KeepRight, ARobotThatMeetsAnotherTurnsToTheRight) {
  const Neighbour comes = neighbour({40, 3}, {-20, 0});
  const Point2 kept = keeping_right({20, 0}, {0, 0}, {&comes, 1});
  EXPECT_EQ(kept.x(), 20);
  EXPECT_LT(kept.y(), 0);
}

TEST(KeepRight, OthersLeaveItItsPreferredVelocity) {
  for (const Neighbour& other : {neighbour({40, 0}, {20, 0}), neighbour({40, 0}, {0, 0}),
                                 neighbour({-40, 0}, {-20, 0}), neighbour({-40, 0}, {20, 0})})
    EXPECT_EQ(keeping_right({20, 0}, {0, 0}, {&other, 1}), Point2(20, 0));
  EXPECT_EQ(keeping_right({20, 0}, {0, 0}, {}), Point2(20, 0));
}

}  // namespace
}  // namespace coppice
