// Tests of what is left of a trajectory, and of when two of them come too close.
#include "coppice/motion/trajectory.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/unit/motion/trajectories.h"

namespace coppice {
namespace {

using test::position_at;

const Trajectory crossing{{0, {0, 0}}, {10, {100, 0}}};

TEST(Trajectory, RobotsThatCrossAtTheSameTimeComeTooClose) {
  EXPECT_TRUE(come_too_close(crossing, {{0, {50, -50}}, {10, {50, 50}}}, 10, 0));
}

TEST(Trajectory, RobotsThatCrossOneAfterTheOtherDoNot) {
  EXPECT_FALSE(come_too_close(crossing, {{20, {50, -50}}, {30, {50, 50}}}, 10, 0));
}

TEST(Trajectory, ARobotStandsBeforeItsTrajectoryAndAfterIt) {
  EXPECT_TRUE(come_too_close(crossing, {{20, {50, 5}}, {30, {50, 50}}}, 10, 0));
  EXPECT_TRUE(come_too_close(crossing, {{-9, {50, 50}}, {-5, {50, 5}}}, 10, 0));
  EXPECT_FALSE(come_too_close(crossing, {{-9, {50, 5}}, {-5, {50, 50}}}, 10, 0));
}

TEST(Trajectory, WhatIsOverDoesNotCount) {
  const Trajectory other{{0, {50, -50}}, {10, {50, 50}}};
  EXPECT_FALSE(come_too_close(crossing, other, 10, 7));
}

TEST(Trajectory, TheRestBeginsWhenTheRobotLeavesThePoint) {
  const Trajectory waits{{1, {0, 0}}, {6, {50, 0}}, {9, {50, 0}}, {14, {50, 50}}};
  EXPECT_EQ(rest_of(waits, 10), (Trajectory{{2, {10, 0}}, {6, {50, 0}}, {9, {50, 0}}, {14, {50, 50}}}));
  EXPECT_EQ(rest_of(waits, 50), (Trajectory{{9, {50, 0}}, {14, {50, 50}}}));
  EXPECT_EQ(rest_of(waits, -1), waits);
  EXPECT_EQ(rest_of(waits, 101), (Trajectory{{14, {50, 50}}}));
}

Trajectory any_trajectory() {
  Trajectory trajectory;
  double time = *rc::gen::inRange(0, 10);
  const int points = *rc::gen::inRange(1, 6);
  for (int k = 0; k < points; ++k) {
    trajectory.push_back({time, Point2(*rc::gen::inRange(0, 30), *rc::gen::inRange(0, 30))});
    time += *rc::gen::inRange(1, 8);
  }
  return trajectory;
}

// Sampled positions are nearly as close as the robots ever are.
RC_GTEST_PROP(Trajectory, TheLeastDistanceIsThatOfSampledPositions, ()) {
  const Trajectory a = any_trajectory();
  const Trajectory b = any_trajectory();
  const double from = *rc::gen::inRange(0, 20);
  double least = 1e9;
  for (double time = from; time < 70; time += 0.005)
    least = std::min(least, (position_at(a, time) - position_at(b, time)).norm());
  RC_ASSERT(come_too_close(a, b, least + 1e-6, from));
  RC_ASSERT(!come_too_close(a, b, least - 0.5, from));
}

}  // namespace
}  // namespace coppice
