// Tests of robots that reserve trajectories, message by message.
#include <memory>
#include <tuple>
#include <vector>

#include "tests/unit/robot_agent/two_reservers.h"

namespace coppice {
namespace {

/// b goes first where the ways cross.
JointPlanMessage plan_of_both() {
  return {.round = {4, "a", {100, 100}, 200},
          .members = {{"a", 5, false, {{1, {20, 100}}, {8, {20, 100}}, {16, {180, 100}}}},
                      {"b", 5, false, {{1, {100, 6}}, {8.7, {100, 160}}}}},
          .basis = {},
          .run = {}};
}

class ReserverTest : public TwoReservers {
 protected:
  /// a has taken up its part of a joint plan and is soon at the crossing. b has not taken up its own: returns
  /// that state.
  RobotState come_to_the_crossing() {
    a.adopt(plan_of_both(), 0.5);
    a.self.position = {80, 100};
    RobotState waits = b.state(0.6);
    waits.round = plan_of_both().round;
    waits.stage = Stage::waiting;
    a.fleet.hear(std::make_shared<const RobotState>(waits), 0.6);
    return waits;
  }
};

TEST_F(ReserverTest, TheRobotWithTheShortestWayReservesFirst) {
  for (Robot* robot : {&a, &b}) robot->want(0);
  tell(b, a);
  tell(a, b);
  tell_state(a, b, 0);
  tell_state(b, a, 0);
  b.plan(0.1);
  EXPECT_FALSE(b.reserver.holds());
  a.plan(0.1);
  ASSERT_TRUE(a.reserver.holds());
  tell(b, a);
  b.plan(0.2);
  ASSERT_TRUE(b.reserver.holds());
  ASSERT_EQ(b.last().basis.size(), 1u);
  EXPECT_EQ(b.last().basis.front().robot, "a");
  EXPECT_EQ(b.last().basis.front().number, a.last().number);
}

TEST_F(ReserverTest, ARobotWaitsForItsTurnForFiveSecondsAtMost) {
  for (Robot* robot : {&a, &b}) robot->want(0);
  tell(b, a);
  b.plan(4.9);
  EXPECT_FALSE(b.reserver.holds());
  b.plan(5.1);
  EXPECT_TRUE(b.reserver.holds());
}

TEST_F(ReserverTest, EachRobotThatComesFirstHasFiveSeconds) {
  for (Robot* robot : {&a, &b}) robot->want(0);
  b.plan(0.1);
  b.plan(4.9);
  tell(b, a);
  b.plan(5);
  b.plan(9.9);
  EXPECT_FALSE(b.reserver.holds());
  b.plan(10.1);
  EXPECT_TRUE(b.reserver.holds());
}

TEST_F(ReserverTest, OfTwoThatPlanAtTheSameTimeTheOneWithTheLongerWayPlansAnew) {
  b.path = {{100, 20}, {100, 181}};  // both would be in the middle at the same time
  b.self.position = b.path.front();
  for (Robot* robot : {&a, &b}) robot->want(0);
  for (Robot* robot : {&a, &b}) robot->plan(5.1);
  ASSERT_TRUE(a.reserver.holds() && b.reserver.holds());
  tell(a, b);
  tell(b, a);
  EXPECT_FALSE(a.is_overridden());
  EXPECT_TRUE(b.is_overridden());
}

// b is to end in the corridor, and to close it.
TEST_F(ReserverTest, ARobotThatFindsNoTrajectoryIsUrgentAndOthersGiveWayToIt) {
  const ClearanceField corridor(
      OccupancyMap{.width = 200, .height = 14, .blocked = std::vector<std::uint8_t>(2800, 0)});
  MapRoadmaps narrow(corridor);
  Robot first{"b", {{60, 7}, {100, 7}}, narrow};
  Robot second{"a", {{20, 7}, {180, 7}}, narrow};
  for (Robot* robot : {&first, &second}) robot->want(0);
  first.plan(5.1);  // it has waited for its turn
  ASSERT_TRUE(first.reserver.holds());
  tell(second, first);
  tell_state(second, first, 5.15);
  second.plan(5.2);
  ASSERT_TRUE(second.reserver.holds());
  EXPECT_EQ(second.last().priority, Priority::urgent);
  EXPECT_TRUE(second.last().basis.empty());
  tell(first, second);
  tell_state(first, second, 5.25);
  EXPECT_TRUE(first.is_overridden());
  EXPECT_FALSE(second.is_overridden());
}

TEST_F(ReserverTest, ARobotPlansAroundALateOneAsLateAsThatIs) {
  for (Robot* robot : {&a, &b}) robot->want(0);
  tell(a, b);
  tell(b, a);
  tell_state(a, b, 0);
  a.plan(0.1);
  tell(b, a);
  const Trajectory& planned = a.last().trajectory;
  tell_state(b, a, planned.front().time + 3);  // a has not set off yet
  b.plan(planned.front().time + 3.1);
  ASSERT_EQ(b.last().basis.size(), 1u);
  EXPECT_NEAR(b.last().basis.front().offset, 3, 0.1);
  EXPECT_FALSE(come_too_close(b.last().trajectory, shifted(planned, 3), 10, 0));
}

// b stands in the corridor. c has a longer way, and its turn before b. Messages take a second.
TEST_F(ReserverTest, ARobotKeepsClearForLongerOfOneThatIsNotNextInTurnIfStatesAreLate) {
  const ClearanceField corridor(
      OccupancyMap{.width = 300, .height = 14, .blocked = std::vector<std::uint8_t>(4200, 0)});
  MapRoadmaps narrow(corridor);
  Robot first{"a", {{20, 7}, {120, 7}}, narrow};
  first.fleet.hear(Mission{.robot = "c", .start = {290, 7}, .goal = {280, 7}, .radius = 5, .clock = {}}, 0);
  const double now = 3;
  first.want(now);
  for (const auto& [name, x, way] : {std::tuple{"b", 100, 60}, std::tuple{"c", 290, 80}}) {
    first.others.hear(
        std::make_shared<const ReservationMessage>(ReservationMessage{.robot = name,
                                                                      .number = 1,
                                                                      .first_number = 1,
                                                                      .radius = 5,
                                                                      .way = static_cast<double>(way),
                                                                      .priority = first.last().priority,
                                                                      .run = {}}));
    RobotState state = state_of(name, now - 1, Point2(x, 7));
    state.phase = Phase::driving;
    state.echoes = {{"a", now - 2, now - 1}};
    first.fleet.hear(std::make_shared<const RobotState>(state), now);
  }
  first.fleet.detect_failures(now, first.self.position, {}, corridor);
  first.plan(now);
  ASSERT_TRUE(first.reserver.holds());
  const double beside_b = rest_of(first.last().trajectory, 100 - 20 - 10).front().time;
  EXPECT_GT(beside_b, now + Timing::sets_off_within + 2);
}

TEST_F(ReserverTest, NobodyCountsOnTheOrderBeforeTheOtherIsKnownToHeedIt) {
  reserve_both();
  a.look();
  RobotState before = b.state(0.3);
  before.knows.clear();
  EXPECT_FALSE(a.reserver.passes(before, 0.05, present));
  const RobotState state = tell_state(a, b, 0.4);
  ASSERT_EQ(state.knows.size(), 1u);
  EXPECT_TRUE(a.reserver.passes(state, 0.05, present));
  EXPECT_FALSE(a.reserver.passes(state, 2.5, present)) << "the state is old";
}

// A robot that was taken for failed, and did not notice, counted on one that had passed its gate meanwhile.
TEST_F(ReserverTest, TheOrderIsDoubtedWhenTheOtherHasPassedAClosedGate) {
  reserve_both();
  a.look();
  const RobotState state = tell_state(a, b, 0.4);
  EXPECT_TRUE(a.reserver.passes(state, 0.05, present));
  RobotState ahead = state;
  ahead.reservation_progress = 100;  // past the gate where it lets a pass first
  EXPECT_FALSE(a.reserver.passes(ahead, 0.05, present));
}

// A state that was older than the return of a robot confirmed the order anew.
TEST_F(ReserverTest, ADoubtedOrderIsConfirmedByWhatTheOtherSaysLater) {
  reserve_both();
  a.look();
  const RobotState state = tell_state(a, b, 0.4);
  EXPECT_TRUE(a.reserver.passes(state, 0.05, present));
  a.reserver.held().doubt_all(present + 0.7);
  EXPECT_FALSE(a.reserver.passes(state, 0.05, present + 0.7)) << "it was said before";
  EXPECT_TRUE(a.reserver.passes(state, 0.05, present + 0.8));
}

TEST_F(ReserverTest, AMemberOfAJointPlanReservesItsPartAndCountsOnTheOthers) {
  a.adopt(plan_of_both(), 0.5);
  ASSERT_TRUE(a.reserver.holds());
  EXPECT_TRUE(a.reserver.executes_plan());
  EXPECT_EQ(a.last().plan.leader, "a");
  EXPECT_EQ(a.last().plan.epoch, 4u);
  EXPECT_EQ(path_of(a.last().trajectory), a.path);
  b.adopt(plan_of_both(), 0.5);
  const RobotState state = look_at_each_other();
  ASSERT_EQ(state.knows.size(), 1u);
  EXPECT_TRUE(a.reserver.passes(state, 0.05, present))
      << "the parts of one plan were planned around each other";
}

// Rounding had put b beyond the place where it stood, and a strayed into it (crossing, --max-speed 19.9).
TEST_F(ReserverTest, TheOrderDoesNotCountWhileTheOtherStandsWhereTheTwoComeTooClose) {
  const JointPlanMessage plan{
      .round = {4, "a", {100, 100}, 200},
      .members = {{"a", 5, false, {{1, {20, 100}}, {10, {89.9, 100}}, {14, {20, 100}}}},
                  {"b", 5, false, {{1, {100, 6}}, {5.7, {100, 100}}, {20, {100, 100}}, {25, {100, 190}}}}},
      .basis = {},
      .run = {}};
  for (Robot* robot : {&a, &b}) robot->adopt(plan, 0.5);
  RobotState state = look_at_each_other();
  state.reservation_progress = 94 + 1e-9;
  EXPECT_TRUE(a.reserver.passes(state, 0.05, present)) << "a is far from there";
  speed_of_a_at(85);
  EXPECT_FALSE(a.reserver.passes(state, 0.05, present));
}

// a was to stand at the beginning of its way for longer. It stands in the middle of b's way.
TEST_F(ReserverTest, ARobotPlansAroundOneThatIsEarlyWhereThatIs) {
  b.path = {{100, 6}, {100, 190}};
  a.adopt(plan_of_both(), 0.5);
  tell(b, a);
  a.self.position = {100, 100};
  RobotState early = a.state(1);
  early.reservation_progress = 80;
  early.echoes = {{"b", 0.999, 1}};
  b.fleet.hear(std::make_shared<const RobotState>(early), 1.001);
  b.want(1);
  b.plan(1.1);
  ASSERT_TRUE(b.reserver.holds());
  EXPECT_FALSE(come_too_close(b.last().trajectory, {{12, {100, 100}}, {16, {180, 100}}}, 10, 1));
}

TEST_F(ReserverTest, AMemberThatHasNotTakenUpItsPartIsWaitedFor) {
  come_to_the_crossing();
  EXPECT_LT(speed_of_a_at(88.78), 0.5);
  EXPECT_EQ(a.reserver.waits_for(), "b");
  b.drop(0.7);
  RobotState left = b.state(0.8);
  left.round = plan_of_both().round;
  a.fleet.hear(std::make_shared<const RobotState>(left), 0.8);
  EXPECT_GT(speed_of_a_at(88.78), 5) << "it has left the plan";
}

// A robot that speeds up slowly got by only a millimetre at a time, and 30 joint plans were in vain.
TEST_F(ReserverTest, ARobotThatWaitsForOneThatBrakesSlowlyBindsItselfToStandUntilThatHasPassed) {
  RobotState waits = come_to_the_crossing();
  speed_of_a_at(88.78);
  ASSERT_EQ(a.reserver.waits_for(), "b");
  EXPECT_EQ(a.reserver.held().lease(0.6), Timing::longest_lease);
  waits.promise.stamp = 0.65;
  waits.max_acceleration = waits.max_speed / 100;
  a.fleet.hear(std::make_shared<const RobotState>(waits), 0.65);
  speed_of_a_at(88.78);
  ASSERT_EQ(a.reserver.waits_for(), "b");
  const double lease = a.reserver.held().lease(0.6);
  EXPECT_GT(lease, 20) << "b speeds up by 0.2 m/s in a second, and has 90 m to go";
  EXPECT_LE(lease, 100) << "b could brake within that";
}

// States and reservations are under way for different times.
TEST_F(ReserverTest, AStateThatIsOlderThanAReservationDoesNotShowThatItIsLeft) {
  for (Robot* robot : {&a, &b}) robot->adopt(plan_of_both(), 0.5);
  tell(a, b);
  a.self.position = {80, 100};  // soon at the crossing
  RobotState waits = b.state(0.4);
  waits.reservation = 0;
  waits.round = plan_of_both().round;
  waits.stage = Stage::waiting;
  a.fleet.hear(std::make_shared<const RobotState>(waits), 0.4);
  EXPECT_LT(speed_of_a_at(88.78), 0.5);
  EXPECT_EQ(a.reserver.waits_for(), "b");
  RobotState left = b.state(0.8);
  left.round.epoch = 5;
  left.stage = Stage::waiting;
  a.fleet.hear(std::make_shared<const RobotState>(left), 0.8);
  EXPECT_GT(speed_of_a_at(88.78), 5);
}

// The gate opened for good once b was sure to be there at its turn, which may come a period after that of a.
TEST_F(ReserverTest, AGateIsClosedUntilTheOtherRobotIsThere) {
  for (Robot* robot : {&a, &b}) robot->adopt(plan_of_both(), 0.5);
  look_at_each_other();
  const auto& members = plan_of_both().members;
  const Gate gate = order_of(members[0].trajectory, 5, members[1].trajectory, 5, 0).gates.front();
  const double before = gate.at - 0.01;
  speed_of_a_at(20 + before);
  const auto may_pass_when_b_said_at = [&](double stamp, double now) {
    RobotState passes = state_of("b", stamp, {100, 6 + gate.needed - 20 * period}, {0, 20});
    passes.reservation = b.reserver.number();
    passes.reservation_progress = gate.needed;  // at its turn
    passes.echoes = {{"a", stamp - 0.001, stamp}};
    a.fleet.hear(std::make_shared<const RobotState>(passes), stamp + 0.001);
    const Driver body({20 + before, 100}, now, 5, limits, period);
    a.reserver.come_to(body);
    a.reserver.held().look_at_gates(a.fleet, now + 0.045, open);
    return a.reserver.held().allows(body, {{0.4, 0}, 0});
  };
  EXPECT_FALSE(may_pass_when_b_said_at(0.74, 0.70));
  EXPECT_TRUE(may_pass_when_b_said_at(0.78, 0.80));
}

TEST_F(ReserverTest, AMemberThatStandsBesideItsStripDoesNotTakeUpItsPart) {
  a.self.radius = 0.1;
  a.self.position = {20, 100.008};
  a.adopt(plan_of_both(), 0.5);
  EXPECT_FALSE(a.reserver.holds());
  a.self.position = {20, 100.005};
  a.adopt(plan_of_both(), 0.6);
  EXPECT_TRUE(a.reserver.holds());
}

TEST_F(ReserverTest, AMemberThatStandsElsewhereSaysThatItHasNoReservation) {
  a.self.position = {30, 100};
  a.adopt(plan_of_both(), 0.5);
  EXPECT_FALSE(a.reserver.holds());
  ASSERT_EQ(a.said.size(), 1u);
  EXPECT_TRUE(a.last().trajectory.empty());
}

TEST_F(ReserverTest, TheJointPlanHoldsAgainstAReservationThatWasMadeMeanwhile) {
  b.path = {{100, 20}, {100, 181}};
  b.self.position = b.path.front();
  b.want(0);
  b.plan(5.1);
  JointPlanMessage plan = plan_of_both();
  plan.members.pop_back();
  plan.members[0].trajectory = {{5, {20, 100}}, {13, {180, 100}}};
  a.adopt(plan, 5.1);
  tell(a, b);
  tell(b, a);
  EXPECT_FALSE(a.is_overridden());
  EXPECT_TRUE(b.is_overridden());
}

TEST_F(ReserverTest, NobodyCountsOnTheOrderOfRobotsThatPlannedWithoutEachOther) {
  for (Robot* robot : {&a, &b}) robot->want(0);
  for (Robot* robot : {&a, &b}) robot->plan(5.1);
  tell(a, b);
  tell(b, a);
  a.look();
  const RobotState state = tell_state(a, b, 5.2);
  ASSERT_EQ(state.knows.size(), 1u);
  EXPECT_FALSE(a.reserver.passes(state, 0.05, present));
}

// c crosses a's way long after a has passed there. Robots had no order with such a one, and crept beside it.
// And a reservation with another number had lost the order with b for one of the two robots only: they
// touched.
TEST_F(ReserverTest, ARobotNamesOneThatPlannedWithoutItAndKeepsItsOrderWithTheOthers) {
  reserve_both();  // b names a
  const std::uint32_t before = a.reserver.number();
  a.others.hear(std::make_shared<const ReservationMessage>(
      ReservationMessage{.robot = "c",
                         .number = 7,
                         .first_number = 7,
                         .radius = 5,
                         .way = 10,
                         .trajectory = {{60, {150, 20}}, {70, {150, 190}}},
                         .basis = {},
                         .priority = a.last().priority,
                         .run = {}}));
  a.look();
  a.reserver.name_those_beside(1, a.said);
  ASSERT_GT(a.reserver.number(), before);
  std::vector<RobotName> named;
  for (const ReservationBasis& known : a.last().basis) named.push_back(known.robot);
  EXPECT_EQ(named, (std::vector<RobotName>{"b", "c"}));
  tell(b, a);
  a.look();
  b.look();
  tell_state(b, a, 1.1);
  const RobotState state = tell_state(a, b, 1.2);
  EXPECT_TRUE(a.reserver.passes(state, 0.05, present)) << "both know the new number";
  EXPECT_TRUE(b.reserver.passes(tell_state(b, a, 1.3), 0.05, present));
}

// The leader had heard b's trajectory under its first number. a has heard it under a later one only.
TEST_F(ReserverTest, AMemberCountsOnARobotThatItsLeaderPlannedAroundUnderAnEarlierNumber) {
  const auto passes_later = [](std::uint32_t first_number) {
    return std::make_shared<const ReservationMessage>(
        ReservationMessage{.robot = "b",
                           .number = 7,
                           .first_number = first_number,
                           .radius = 5,
                           .trajectory = {{40, {100, 6}}, {50, {100, 190}}},
                           .run = {}});
  };
  const JointPlanMessage plan{.round = {4, "c", {100, 100}, 200},
                              .members = {{"a", 5, false, {{1, {20, 100}}, {9, {180, 100}}}}},
                              .basis = {{"b", 5, 0}},
                              .run = {}};
  a.others.hear(passes_later(5));
  a.adopt(plan, 0.5);
  a.look();
  EXPECT_EQ(a.reserver.held().basis().size(), 1u);
  Robot other{"a", a.path, roadmaps};
  other.others.hear(passes_later(6));
  other.adopt(plan, 0.5);
  other.look();
  EXPECT_TRUE(other.reserver.held().basis().empty()) << "the leader planned around another trajectory";
}

TEST_F(ReserverTest, TheOrderCountsUntilRobotsComeTooCloseAtTheirGoals) {
  const JointPlanMessage plan{.round = {4, "a", {100, 100}, 200},
                              .members = {{"a", 5, false, {{1, {20, 100}}, {9, {180, 100}}}},
                                          {"b", 5, false, {{1, {180, 6}}, {9, {180, 89.9}}}}},
                              .basis = {},
                              .run = {}};
  b.self.position = {180, 6};
  for (Robot* robot : {&a, &b}) robot->adopt(plan, 0.5);
  const RobotState state = look_at_each_other();
  EXPECT_TRUE(a.reserver.passes(state, 0.05, present));
  speed_of_a_at(178);
  EXPECT_FALSE(a.reserver.passes(state, 0.05, present))
      << "the two are to stand closer than trajectories keep apart";
}

}  // namespace
}  // namespace coppice
