// Tests of a robot's part in coordination rounds without an agent.
#include "robot_agent/coordination_round.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

RobotState calls(std::uint32_t epoch) {
  return {.robot = "b", .round = {epoch, "b", {10, 0}, 20}, .stage = Stage::waiting};
}
std::shared_ptr<const JointPlanMessage> plan(std::uint32_t epoch) {
  return std::make_shared<const JointPlanMessage>(
      JointPlanMessage{.round = calls(epoch).round, .members = {{"a", 1, false}}, .moves = {}});
}

// Epochs wrap around: epoch 1 comes after the last one.
TEST(CoordinationRound, ARestartedRobotJoinsRoundsThatAreLaterThanItsLastOne) {
  constexpr std::uint32_t last = 4294967295;
  for (const bool by_plan : {false, true}) {
    CoordinationRound round("a");
    round.forget(last, false);
    const auto hear = [&](std::uint32_t epoch) {
      if (by_plan) {
        round.hear(plan(epoch));
      } else {
        round.hear(calls(epoch), Point2(0, 0));
      }
    };
    for (const std::uint32_t epoch : {last - 1, last}) {
      hear(epoch);
      EXPECT_EQ(round.stage(), Stage::free) << epoch;
    }
    hear(1);
    EXPECT_EQ(round.stage(), Stage::waiting);
    EXPECT_EQ(round.id().epoch, 1u);
  }
}

TEST(CoordinationRound, FailuresOnTheWayToOneGoalDoNotCountForTheNextGoal) {
  CoordinationRound round("a");
  const FleetMember here{.robot = "a", .radius = 1, .stands = true, .round = {}};
  for (int k = 0; k < 3; ++k) round.call_everybody(here, k);
  EXPECT_EQ(round.calls_in_vain(), 3);
  round.forget_failures();
  EXPECT_EQ(round.calls_in_vain(), 0);
  EXPECT_FALSE(round.stranded());
}

/// Robot a must drive to where b stands, after b has driven 25 m to the right. Robot b reports only how far
/// it came before its part ended. Returns where a comes within 10 s.
Point2 where_a_comes(CoordinationRound& round, double b_has_come) {
  const ClearanceField field(test::open_map(100, 100));
  MapRoadmaps places(field);
  Fleet fleet("a");
  const Mission mission{.map_id = "m", .radius = 1, .max_speed = 5, .max_acceleration = 10, .clock = {}};
  for (const char* robot : {"a", "b"}) {
    Mission own = mission;
    own.robot = robot;
    fleet.hear(own, 0);
  }
  RobotState b{
      .robot = "b", .promise = {.position = {20, 20}}, .radius = 1, .max_speed = 5, .max_acceleration = 10};
  b.round = {4, "b", {20, 20}, 50};
  b.stage = Stage::waiting;
  FleetMember a{.robot = "a", .position = {20, 30}, .radius = 1, .max_speed = 5, .stands = true, .round = {}};
  round.hear(b, a.position);
  round.hear(std::make_shared<const JointPlanMessage>(
      JointPlanMessage{.round = b.round,
                       .members = {{"a", 1, false}, {"b", 1, false}},
                       .moves = {{1, {{20, 20}, {45, 20}}}, {0, {{20, 30}, {20, 20}}}}}));
  round.wait(a, fleet, places, 0);
  EXPECT_EQ(round.stage(), Stage::executing);
  b.stage = Stage::free;
  b.progress = b_has_come;
  fleet.hear(std::make_shared<const RobotState>(b), 0);
  round.hear(b, a.position);
  for (double now = 0; now < 10 && round.stage() == Stage::executing; now += control_period) {
    a.round = round.id();
    const Point2 wanted = round.preferred_velocity(a, fleet, a.position, {5, 10}, now);
    a.position += control_period * wanted;
    a.stands = wanted.isZero(0);
  }
  return a.position;
}

TEST(CoordinationRound, ARobotThatFinishedItsMovesOpensItsGates) {
  CoordinationRound round("a");
  EXPECT_LT((where_a_comes(round, 25) - Point2(20, 20)).norm(), 0.1);
  EXPECT_EQ(round.stage(), Stage::free);
  EXPECT_NEAR(round.progress(), 10, 0.1) << "peers that missed the state must learn that the moves are done";
  round.leave();
  EXPECT_NEAR(round.progress(), 10, 0.1);
}

TEST(CoordinationRound, ARobotThatLeavesBeforeItsLastMoveCausesANewRound) {
  CoordinationRound round("a");
  EXPECT_GT((where_a_comes(round, 3) - Point2(20, 20)).norm(), 2);
  EXPECT_EQ(round.stage(), Stage::waiting);
  EXPECT_EQ(round.id().epoch, 5u);
  EXPECT_EQ(round.id().leader, "a");
}

}  // namespace
}  // namespace coppice
