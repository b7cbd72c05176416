// Tests of what is left of a robot's path, of its waits, and of its progress.

#include "monitor/view/robot_progress.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

RobotState at(double time, const Point2& position) {
  return {
      .robot = "a", .promise = {.stamp = time, .position = position}, .radius = 0.5, .phase = Phase::driving};
}

/// A path there and back, 1 m apart.
const Path hairpin{{0, 0}, {100, 0}, {100, 1}, {0, 1}};

TEST(RobotProgress, ThereIsNoDistanceWithoutAPath) {
  RobotProgress progress;
  EXPECT_EQ(progress.way_left({0, 0}), std::nullopt);
  progress.follow(hairpin);
  EXPECT_DOUBLE_EQ(*progress.way_left({0, 0}), 201);
  progress.follow({});
  EXPECT_EQ(progress.way_left({0, 0}), std::nullopt);
}

TEST(RobotProgress, APathOfOnePointLeadsThere) {
  RobotProgress progress;
  progress.follow({{3, 4}});
  EXPECT_DOUBLE_EQ(*progress.way_left({0, 0}), 5);
}

TEST(RobotProgress, ALaterPartOfThePathIsNotTakenForTheCurrentOne) {
  RobotProgress progress;
  progress.follow(hairpin);
  for (int metre = 0; metre <= 50; ++metre) progress.on(at(metre, {metre, 0}));
  EXPECT_DOUBLE_EQ(*progress.way_left({50, 0}), 151);
  progress.on(at(51, {50, 0.6}));
  EXPECT_DOUBLE_EQ(*progress.way_left({50, 0.6}), 151.6) << "it was pushed aside, towards the way back";
}

TEST(RobotProgress, ARobotThatRejoinsItsPathFurtherOnHasLessToGo) {
  RobotProgress progress;
  progress.follow({{0, 0}, {100, 0}});
  progress.on(at(0, {0, 0}));
  progress.on(at(1, {40, 30}));
  EXPECT_DOUBLE_EQ(*progress.way_left({40, 30}), 90);
  progress.on(at(2, {60, 0}));
  EXPECT_DOUBLE_EQ(*progress.way_left({60, 0}), 40);
}

TEST(RobotProgress, AWaitIsTimedFromItsBeginningAndWaitsAreSummed) {
  RobotProgress progress;
  RobotState waits = at(10, {0, 0});
  waits.waits_for = "b";
  progress.on(at(9, {0, 0}));
  progress.on(waits);
  waits.promise.stamp = 12;
  progress.on(waits);
  EXPECT_DOUBLE_EQ(progress.waiting(13), 3);
  progress.on(at(14, {0, 0}));
  EXPECT_DOUBLE_EQ(progress.waiting(15), 0);
  EXPECT_DOUBLE_EQ(progress.waited(15), 4);
  RobotState holds = at(20, {0, 0});
  holds.stage = Stage::waiting;
  progress.on(holds);
  EXPECT_DOUBLE_EQ(progress.waiting(21), 1) << "for a joint plan";
  EXPECT_DOUBLE_EQ(progress.waited(21), 5);
}

TEST(RobotProgress, ARobotThatComesNoNearerMakesNoProgress) {
  RobotProgress progress;
  progress.begin_mission();
  progress.follow({{0, 0}, {100, 0}});
  for (int second = 0; second <= 10; ++second) progress.on(at(second, {second, 0}));
  EXPECT_DOUBLE_EQ(progress.without_progress(10.5), 0.5);
  for (int second = 11; second <= 30; ++second) progress.on(at(second, {10 - second % 2, 0}));
  EXPECT_DOUBLE_EQ(progress.without_progress(30), 20);
  progress.follow({{10, 0}, {10, 5}, {100, 5}});
  progress.on(at(31, {10, 0}));
  EXPECT_DOUBLE_EQ(progress.without_progress(31), 21) << "a new path alone is no progress";
  progress.on(at(32, {10, 1}));
  EXPECT_DOUBLE_EQ(progress.without_progress(33), 1);
}

TEST(RobotProgress, AnArrivedRobotLacksNoProgress) {
  RobotProgress progress;
  progress.follow({{0, 0}, {1, 0}});
  progress.on(at(1, {0, 0}));
  RobotState arrived = at(2, {1, 0});
  arrived.phase = Phase::arrived;
  progress.on(arrived);
  EXPECT_DOUBLE_EQ(progress.without_progress(100), 0);
}

}  // namespace
}  // namespace coppice
