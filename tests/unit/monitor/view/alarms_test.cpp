// Tests of what an operator is told to look at.

#include "monitor/view/alarms.h"

#include <gtest/gtest.h>

#include "tests/unit/monitor/seen_fleet.h"

namespace coppice {
namespace {

struct Alarms : testing::Test {
  test::SeenFleet fleet;
  AlarmBoard board;

  const std::vector<Alarm>& after(double seconds) {
    fleet.now += seconds;
    board.look(fleet.view, fleet.now);
    return board.alarms();
  }
  void robot(const RobotName& name, Phase phase = Phase::driving) {
    fleet.mission(name);
    fleet.state(name, {1, 1});
    fleet.status(name, phase);
  }
  void periods(const RobotName& name, std::uint32_t all, std::uint32_t missed) {
    AgentStatus status{.robot = name, .mission = 1, .phase = Phase::driving};
    status.load.periods = all;
    status.load.periods_missed = missed;
    fleet.hear(status);
  }
};

TEST_F(Alarms, ASilentRobotAlarmsAlsoIfItHadArrived) {
  robot("a", Phase::arrived);
  robot("b");
  EXPECT_TRUE(after(2.9).empty());
  fleet.state("b", {2, 1});
  const auto& alarms = after(0.2);
  ASSERT_EQ(alarms.size(), 1u);
  EXPECT_EQ(alarms[0], (Alarm{AlarmKind::robot_silent, "a", 100,
                              "a is not heard: its agent has ended, hangs, or cannot be reached"}));
  EXPECT_EQ(board.count(AlarmKind::robot_silent), 1u);
  EXPECT_EQ(after(2), std::vector<Alarm>(alarms)) << "it stays the same";
  fleet.state("a", {1, 1});
  fleet.state("b", {2, 1});
  EXPECT_TRUE(after(0).empty()) << "it is heard again";
}

TEST_F(Alarms, ARobotWhoseAgentNeverSpokeAlarmsAfterTheTimeThatAStartTakes) {
  fleet.mission("a");
  EXPECT_TRUE(after(9.9).empty());
  ASSERT_EQ(after(0.2).size(), 1u);
  EXPECT_EQ(board.alarms()[0].since, 100);
}

TEST_F(Alarms, StatusesDoNotStandForStates) {
  robot("a");
  fleet.now += 4;
  fleet.status("a", Phase::driving);
  EXPECT_EQ(after(0).size(), 1u) << "others avoid it by its states";
}

TEST_F(Alarms, AfterTheEndOfARunNobodyNeedsToAct) {
  robot("a", Phase::no_path);
  robot("b");
  EXPECT_EQ(after(4).size(), 2u);
  fleet.end_of_run("a");
  EXPECT_EQ(after(0).size(), 1u) << "a robot whose mission has ended is none of them";
  fleet.end_of_run("b");
  EXPECT_TRUE(after(0).empty());
}

TEST_F(Alarms, ARobotThatCannotGoOnAlarmsWithItsReason) {
  robot("a");
  AgentStatus status{
      .robot = "a", .mission = 1, .phase = Phase::gave_up, .reason = "a wall stands in its way"};
  fleet.hear(status);
  after(1);
  fleet.state("a", {1, 1});
  ASSERT_EQ(after(1).size(), 1u);
  EXPECT_EQ(board.alarms()[0].kind, AlarmKind::robot_failed);
  EXPECT_EQ(board.alarms()[0].text, "a cannot go on: a wall stands in its way");
  EXPECT_EQ(board.alarms()[0].since, 101) << "since it was seen first";
  status.phase = Phase::driving;
  fleet.hear(status);
  EXPECT_TRUE(after(0).empty());
}

TEST_F(Alarms, ManyMissedPeriodsAlarmUntilTheyAreFew) {
  robot("a");
  periods("a", 100, 0);
  periods("a", 200, 9);
  EXPECT_TRUE(after(0).empty());
  periods("a", 300, 19);
  ASSERT_EQ(after(0).size(), 1u);
  EXPECT_EQ(board.alarms()[0].kind, AlarmKind::periods_missed);
  periods("a", 400, 26);
  EXPECT_EQ(after(0).size(), 1u) << "an alarm does not come and go";
  periods("a", 500, 30);
  EXPECT_TRUE(after(0).empty());
}

TEST_F(Alarms, AServiceThatWasHeardAndIsNotAnyMoreAlarms) {
  robot("a");
  EXPECT_TRUE(after(0).empty()) << "recordings and other fleets may hold none";
  fleet.hear(ServiceStatus{.service = 7, .since = 90});
  fleet.now += 4;
  fleet.state("a", {1, 1});
  ASSERT_EQ(after(0).size(), 1u);
  EXPECT_EQ(board.alarms()[0].kind, AlarmKind::service_silent);
  EXPECT_EQ(board.alarms()[0].robot, "");
  EXPECT_EQ(board.alarms()[0].since, 100);
  fleet.hear(ServiceStatus{.service = 8, .since = 104});
  EXPECT_TRUE(after(0).empty()) << "another one has the fleet";
}

TEST_F(Alarms, AServiceWhoseDiskIsFullAlarms) {
  robot("a");
  const ServiceStatus status{.service = 7, .since = 90, .problem = "no space left on device"};
  fleet.hear(status);
  ASSERT_EQ(after(1).size(), 1u);
  EXPECT_EQ(board.alarms()[0], (Alarm{AlarmKind::orders_refused, "", 101,
                                      "the planner service takes no new orders: no space left on device"}));
  fleet.now += 4;
  fleet.state("a", {1, 1});
  ASSERT_EQ(after(0).size(), 1u) << "one alarm of a service at a time";
  EXPECT_EQ(board.alarms()[0].kind, AlarmKind::service_silent);
  fleet.hear(ServiceStatus{.service = 7, .since = 90});
  EXPECT_TRUE(after(0).empty());
}

}  // namespace
}  // namespace coppice
