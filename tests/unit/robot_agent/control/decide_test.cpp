#include <gtest/gtest.h>

#include "robot_agent/control/decision.h"
#include "robot_agent/timing.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

constexpr Limits limits{20, 40};

/// A robot that stands in the open, has a path, and waits for its turn to reserve.
class Decide : public testing::Test {
 protected:
  Decision decided() const {
    return decide({.now = 1,
                   .robot = robot,
                   .body = body,
                   .task = task,
                   .held = nullptr,
                   .executes_plan = false,
                   .leads_elsewhere = false,
                   .waits_for_its_turn = true,
                   .stage = stage,
                   .is_stranded = is_stranded,
                   .last_moved = 1,
                   .faces = faces,
                   .joins = joins,
                   .is_behind = is_behind,
                   .listens = listens,
                   .may_leave_strip = may_leave_strip,
                   .may_set_off = may_set_off,
                   .fleet = fleet,
                   .neighbours = neighbours,
                   .field = field,
                   .coordination = coordination});
  }
  static Driving driving() { return {{PathFollower({{50, 50}, {90, 50}}, 5)}}; }
  /// Another robot drives straight towards this one, which must evade it.
  void let_somebody_come() {
    neighbours = {{.promise = {.stamp = 0.95,
                               .position = {62, 50.5},
                               .velocity = {-4, 0},
                               .decision_time = 1,
                               .next_velocity = {-4, 0},
                               .expiry = 1.05},
                   .radius = 5,
                   .limits = limits,
                   .clock_error = 0}};
  }

  ClearanceField field{test::open_map(100, 100)};
  Fleet fleet{"a"};
  RobotName robot = "a";
  Driver body{{50, 50}, 1, 5, limits, control_period};
  Task task = driving();
  Stage stage = Stage::free;
  bool is_stranded = false, joins = false, is_behind = false, listens = false;
  bool may_leave_strip = true, may_set_off = true;
  std::optional<double> faces{};
  std::vector<Neighbour> neighbours{};
  Coordination coordination = Coordination::reservations;
};

TEST_F(Decide, TheStrictestHoldIsTheCause) {
  may_set_off = may_leave_strip = false;
  EXPECT_EQ(decided().cause, Cause::strip);
  listens = true;
  EXPECT_EQ(decided().cause, Cause::listening);
  is_behind = true;
  EXPECT_EQ(decided().cause, Cause::odometry);
  joins = true;
  EXPECT_EQ(decided().cause, Cause::joining);
  task = Halted{};
  EXPECT_EQ(decided().cause, Cause::halted);
}

TEST_F(Decide, ARobotThatIsHeldStandsAndEvadesNobody) {
  let_somebody_come();
  listens = true;
  const Decision d = decided();
  ASSERT_TRUE(std::holds_alternative<StandUntil>(d.action));
  EXPECT_NEAR(std::get<StandUntil>(d.action).until, 1 + Timing::waiting_lease, 0.01);
  EXPECT_TRUE(d.pauses_stall_clock);
}

TEST_F(Decide, ARobotThatIsHeldWhileItDrivesBrakes) {
  for (int period = 0; period < 5; ++period) {
    body.take(body.following({20, 0}, {}, field).next);
    body.advance();
  }
  listens = true;
  const Decision d = decided();
  EXPECT_TRUE(std::holds_alternative<Brake>(d.action));
  EXPECT_EQ(next_twist(d, body).velocity, body.braking().velocity);
}

TEST_F(Decide, ARobotInItsStripThatIsAboutToKnowTheOthersDoesNotBindItself) {
  may_leave_strip = may_set_off = false;
  EXPECT_TRUE(std::holds_alternative<Brake>(decided().action));
  may_set_off = true;
  EXPECT_TRUE(std::holds_alternative<StandUntil>(decided().action));
}

TEST_F(Decide, ARobotWithoutAWayOfItsOwnSaysWhatItWaitsFor) {
  may_set_off = false;
  EXPECT_EQ(decided().cause, Cause::startup);
  may_set_off = true;
  is_stranded = true;
  EXPECT_EQ(decided().cause, Cause::stranded);
  stage = Stage::waiting;
  EXPECT_EQ(decided().cause, Cause::joint_plan);
  task = Planning{};
  EXPECT_EQ(decided().cause, Cause::planning);
  task = Impossible{};
  stage = Stage::free;
  EXPECT_EQ(decided().cause, Cause::idle);
}

TEST_F(Decide, ARobotWithNothingToDoBindsItselfForLongerThanOneThatWaits) {
  task = Impossible{};
  EXPECT_NEAR(std::get<StandUntil>(decided().action).until, 1 + Timing::idle_lease, 0.01);
  stage = Stage::waiting;
  EXPECT_NEAR(std::get<StandUntil>(decided().action).until, 1 + Timing::waiting_lease, 0.01);
}

TEST_F(Decide, ARobotThatIsNotHeldEvadesOneThatComes) {
  let_somebody_come();
  const Decision d = decided();
  EXPECT_EQ(d.cause, Cause::reservation);
  ASSERT_TRUE(std::holds_alternative<Evade>(d.action));
  EXPECT_LT(std::get<Evade>(d.action).next.velocity.x(), 0);
}

TEST_F(Decide, WithoutReservationsTheRobotDrivesAlongItsPath) {
  coordination = Coordination::rvo;
  ASSERT_TRUE(std::get<Driving>(task).route.follower.look_from({50, 50}, field, limits));
  const Decision free = decided();
  ASSERT_TRUE(std::holds_alternative<Follow>(free.action));
  EXPECT_TRUE(free.comes_on);
  EXPECT_NEAR(std::get<Follow>(free.action).next.velocity.x(), limits.max_acceleration * control_period,
              1e-9);
}

TEST_F(Decide, ADifferentialRobotThatStandsAtItsGoalTurnsToItsYawWhileItIsBound) {
  const Limits turning{1, 1, 2, 4};
  body = Driver({50, 50}, 1, 5, turning, control_period, 0);
  task = Impossible{};
  faces = 1.5;
  const Decision d = decided();
  ASSERT_TRUE(std::holds_alternative<StandUntil>(d.action));
  EXPECT_GT(std::get<StandUntil>(d.action).angular_velocity, 0);
  EXPECT_GT(next_twist(d, body).angular_velocity, 0);
}

}  // namespace
}  // namespace coppice
