// What a robot's part in knots does without an agent around it.
#include "robot_agent/knot.h"

#include <memory>

#include <gtest/gtest.h>

namespace coppice {
namespace {

RobotState calls(std::uint32_t epoch) {
  return {.robot = "b", .knot = {epoch, "b", {10, 0}, 20}, .stage = Stage::holding};
}
std::shared_ptr<const JointPlanMessage> plan(std::uint32_t epoch) {
  return std::make_shared<const JointPlanMessage>(
      JointPlanMessage{.knot = calls(epoch).knot, .members = {{"a", 1, false}}, .moves = {}});
}

// Epochs count round: 1 comes after the last one.
TEST(Knot, WhoWasStartedAnewJoinsWhatIsLaterThanWhatItForgot) {
  constexpr std::uint32_t last = 4294967295;
  for (const bool by_plan : {false, true}) {
    Knot knot("a");
    knot.forget(last);
    const auto hear = [&](std::uint32_t epoch) {
      if (by_plan) {
        knot.hear(plan(epoch));
      } else {
        knot.hear(calls(epoch), Point2(0, 0));
      }
    };
    for (const std::uint32_t epoch : {last - 1, last}) {
      hear(epoch);
      EXPECT_EQ(knot.stage(), Stage::free) << epoch;
    }
    hear(1);
    EXPECT_EQ(knot.stage(), Stage::holding);
    EXPECT_EQ(knot.id().epoch, 1u);
  }
}

TEST(Knot, WhatFailedOnTheWayToOneGoalSaysNothingOfTheNext) {
  Knot knot("a");
  const FleetMember here{.robot = "a", .radius = 1, .stands = true, .knot = {}};
  for (int k = 0; k < 3; ++k) knot.call_everybody(here, k);
  EXPECT_EQ(knot.calls_in_vain(), 3);
  knot.forget_failures();
  EXPECT_EQ(knot.calls_in_vain(), 0);
  EXPECT_FALSE(knot.stranded());
}

}  // namespace
}  // namespace coppice
