// Tests of a robot's part in coordination rounds without an agent.
#include "robot_agent/agreement/coordination_round.h"

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
      JointPlanMessage{.round = calls(epoch).round, .members = {{"a", 1, false}}});
}

// Epochs wrap around: epoch 1 comes after the last one.
TEST(CoordinationRound, ARestartedRobotJoinsRoundsThatAreLaterThanItsLastOne) {
  constexpr std::uint32_t last = 4294967295;
  for (const bool by_plan : {false, true}) {
    CoordinationRound round("a");
    round.forget(last);
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

TEST(CoordinationRound, AMemberIsGivenThePlanOnceAndIsFree) {
  const ClearanceField field(test::open_map(100, 100));
  MapRoadmaps roadmaps(field);
  const Fleet fleet("a");
  const Reservations others;
  const Reserver reserver("a", {}, others);
  FleetMember a{.robot = "a", .position = {5, 5}, .radius = 1, .round = {}};
  CoordinationRound round("a");
  round.hear(calls(4), a.position);
  round.hear(std::make_shared<const JointPlanMessage>(
      JointPlanMessage{.round = calls(4).round, .members = {{"a", 1, true}, {"b", 1, false}}}));
  round.wait(a, fleet, reserver, roadmaps, 0);
  EXPECT_EQ(round.stage(), Stage::waiting) << "it still brakes";
  EXPECT_EQ(round.take_up(), nullptr);
  a.stands = true;
  round.wait(a, fleet, reserver, roadmaps, 0.05);
  EXPECT_EQ(round.stage(), Stage::free);
  EXPECT_TRUE(round.stranded());
  const auto plan = round.take_up();
  ASSERT_NE(plan, nullptr);
  EXPECT_EQ(plan->round, calls(4).round);
  EXPECT_EQ(round.take_up(), nullptr);
}

Mission mission_of(const char* robot, const Point2& start) {
  return {.robot = robot, .number = 1, .fleet_size = 2, .map_id = "m", .start = start, .radius = 1};
}

TEST(CoordinationRound, ARobotWithoutOthersCallsNone) {
  const ClearanceField field(test::open_map(100, 100));
  const MapRoadmaps roadmaps(field);
  Fleet fleet("a");
  fleet.hear(mission_of("a", {5, 5}), 0);
  CoordinationRound round("a");
  round.call({.robot = "a", .position = {5, 5}, .radius = 1, .stands = true, .round = {}}, {{5, 5}, {9, 5}},
             fleet, roadmaps, 0);
  EXPECT_EQ(round.stage(), Stage::free);
  EXPECT_EQ(round.id().epoch, 0u);
}

TEST(CoordinationRound, TheNearestRobotIsWithinReachHoweverFarItIs) {
  const ClearanceField field(test::open_map(100, 100));
  const MapRoadmaps roadmaps(field);
  Fleet fleet("a");
  fleet.hear(mission_of("a", {5, 5}), 0);
  fleet.hear(mission_of("b", {90, 90}), 0);
  CoordinationRound round("a");
  round.call({.robot = "a", .position = {5, 5}, .radius = 1, .stands = true, .round = {}}, {{5, 5}, {9, 5}},
             fleet, roadmaps, 0);
  EXPECT_EQ(round.stage(), Stage::waiting);
  EXPECT_TRUE(round.id().includes({90, 90}));
}

// A robot that an operator halts for a moment leaves the round, and does not join the same one again.
TEST(CoordinationRound, ALeaderForWhichSomebodyDoesNotWaitCallsAnew) {
  const ClearanceField field(test::open_map(100, 100));
  MapRoadmaps roadmaps(field);
  Fleet fleet("a");
  const Reservations others;
  const Reserver reserver("a", {}, others);
  fleet.hear(mission_of("a", {5, 5}), 0);
  fleet.hear(mission_of("b", {8, 5}), 0);
  const FleetMember a{.robot = "a", .position = {5, 5}, .radius = 1, .stands = true, .round = {}};
  CoordinationRound round("a");
  round.call(a, {{5, 5}, {9, 5}}, fleet, roadmaps, 0);
  const RoundId first = round.id();
  for (double now = 0; now < 59; now += 1) round.wait(a, fleet, reserver, roadmaps, now);
  EXPECT_EQ(round.id(), first);
  round.wait(a, fleet, reserver, roadmaps, 61);
  EXPECT_TRUE(round.id().overrides(first));
  EXPECT_EQ(round.stage(), Stage::waiting);
}

// A packed roadmap of the whole map would take gigabytes.
TEST(CoordinationRound, OnAMapThatIsTooLargeThereIsNone) {
  const ClearanceField field(test::open_map(2'000, 2'000));
  const MapRoadmaps roadmaps(field);
  Fleet fleet("a");
  fleet.hear(mission_of("a", {5, 5}), 0);
  fleet.hear(mission_of("b", {8, 5}), 0);
  FleetMember a{.robot = "a", .position = {5, 5}, .radius = 0.5, .stands = true, .round = {}};
  CoordinationRound round("a");
  round.call(a, {{5, 5}, {9, 5}}, fleet, roadmaps, 0);
  EXPECT_EQ(round.stage(), Stage::free);
  a.radius = 1;
  round.call(a, {{5, 5}, {9, 5}}, fleet, roadmaps, 0);
  EXPECT_EQ(round.stage(), Stage::waiting);
}

}  // namespace
}  // namespace coppice
