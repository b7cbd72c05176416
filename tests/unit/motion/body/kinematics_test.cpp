#include "coppice/motion/kinematics.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(Kinematics, TheFreeFlowTimeIsThatOfSpeedingUpAndBraking) {
  const Limits limits{.max_speed = 2, .max_acceleration = 4};
  EXPECT_DOUBLE_EQ(free_flow_time(0, limits), 0);
  EXPECT_DOUBLE_EQ(free_flow_time(0.25, limits), 0.5);  // 0.125 m each way at 4 m/s2: the top speed is 1 m/s
  EXPECT_DOUBLE_EQ(free_flow_time(1, limits), 1);       // just reaches 2 m/s
  EXPECT_DOUBLE_EQ(free_flow_time(11, limits), 6);      // 10 m more at 2 m/s
}

TEST(Kinematics, TheLeastTimeIsThatOfSpeedingUpFromThePresentSpeed) {
  const Limits limits{.max_speed = 2, .max_acceleration = 4};
  EXPECT_DOUBLE_EQ(least_time(0, 1, limits), 0);
  EXPECT_DOUBLE_EQ(least_time(0.125, 0, limits), 0.25);  // it drives at 1 m/s then
  EXPECT_DOUBLE_EQ(least_time(0.375, 1, limits), 0.25);  // from 1 to 2 m/s
  EXPECT_DOUBLE_EQ(least_time(10.5, 0, limits), 5.5);    // 0.5 m until 2 m/s
  EXPECT_DOUBLE_EQ(least_time(10, 2, limits), 5);
}

}  // namespace
}  // namespace coppice
