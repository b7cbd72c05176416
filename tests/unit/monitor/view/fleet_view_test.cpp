// Tests of what a monitor knows after the messages of a fleet.
#include "monitor/view/fleet_view.h"

#include <memory>

#include <gtest/gtest.h>

namespace coppice {
namespace {

MapMessage map_named(const std::string& id) {
  MapMessage message{.map_id = id, .map = {}};
  message.map.width = 4;
  message.map.height = 2;
  message.map.blocked.assign(8, 0);
  return message;
}

Mission mission_of(const RobotName& robot, std::uint32_t number, FleetClock clock = {100, 1}) {
  return {.robot = robot, .number = number, .map_id = "m", .radius = 1, .clock = clock};
}

RobotState state_of(const RobotName& robot, double stamp, const Point2& place) {
  return {.robot = robot,
          .promise = {.stamp = stamp,
                      .position = place,
                      .velocity = {2, 0},
                      .decision_time = stamp + 1,
                      .next_velocity = {0, 4},
                      .expiry = stamp + 2},
          .radius = 1};
}

struct FleetViewTest : testing::Test {
  template <class M>
  void hear(M message, WallTime at = 100) {
    view.on(std::make_shared<const Message>(std::move(message)), at);
  }
  const SeenRobot& robot(const RobotName& name) const { return view.robots().at(view.find(name).value()); }
  FleetView view;
};

TEST_F(FleetViewTest, RobotsAreListedInTheOrderOfTheirFirstMessages) {
  hear(state_of("b", 1, {0, 0}));
  hear(mission_of("a", 1));
  hear(AgentStatus{.robot = "c"});
  hear(state_of("b", 2, {5, 5}), 102);
  hear(state_of("b", 1.5, {9, 9}), 103);  // it comes late
  ASSERT_EQ(view.robots().size(), 3u);
  EXPECT_EQ(view.robots()[0].name, "b");
  EXPECT_EQ(view.robots()[1].name, "a");
  EXPECT_EQ(view.robots()[2].name, "c");
  EXPECT_EQ(robot("b").state->promise.stamp, 2);
  EXPECT_EQ(robot("b").heard, 102);
}

// The fleet keeps its own time when the clock of its host is set, and this process started after that.
TEST_F(FleetViewTest, FleetTimeIsThatOfTheFleetHoweverTheClocksDiffer) {
  for (const double off : {3600.0, -3600.0, 30.0, -30.0}) {
    FleetView late;
    const auto tell = [&](const Message& message, WallTime at) {
      late.on(std::make_shared<const Message>(message), at);
    };
    tell(mission_of("a", 1, {1000, 2}), 1100 + off);
    tell(state_of("a", 200, {0, 0}), 1100 + off);
    EXPECT_NEAR(late.fleet_time(1110 + off).value(), 220, 0.01) << off;
    tell(state_of("a", 219, {0, 0}), 1110 + off);
    EXPECT_NEAR(late.fleet_time(1110 + off).value(), 220, 0.01) << "a state that took half a second";
  }
  hear(mission_of("a", 1));
  hear(state_of("a", 1, {0, 0}), 102);
  EXPECT_EQ(view.fleet_time(102), 2) << "a state that took a second";
}

TEST_F(FleetViewTest, ARelayedStateAddsNoRobot) {
  RobotState state = state_of("b", 1, {0, 0});
  state.passed_on = true;
  hear(state);
  EXPECT_TRUE(view.robots().empty());
}

TEST_F(FleetViewTest, ARobotFollowsItsPromiseAndThenStands) {
  const RobotState state = state_of("a", 10, {1, 1});
  EXPECT_EQ(position_at(state, 9), Point2(1, 1));
  EXPECT_EQ(position_at(state, 10.5), Point2(2, 1));
  EXPECT_EQ(position_at(state, 11.5), Point2(3, 3));
  EXPECT_EQ(position_at(state, 99), Point2(3, 5));
}

TEST_F(FleetViewTest, TheWaitCauseIsTheOneThatTheAgentGives) {
  RobotState state = state_of("a", 10, {1, 1});
  state.phase = Phase::driving;
  hear(state);
  EXPECT_FALSE(wait_of(robot("a"), 10));
  state.promise.stamp = 12;
  state.waits_for = "b";
  hear(state);
  hear(AgentStatus{.robot = "a", .phase = Phase::driving, .wait_cause = "c is in the way", .came_on_at = 8});
  const auto wait = wait_of(robot("a"), 15);
  ASSERT_TRUE(wait);
  EXPECT_EQ(wait->cause, "c is in the way");
  EXPECT_DOUBLE_EQ(wait->seconds, 7);
}

/// Older recordings hold no cause.
TEST_F(FleetViewTest, TheWaitCauseFollowsFromTheStateIfTheAgentGivesNone) {
  RobotState state = state_of("a", 12, {1, 1});
  state.phase = Phase::driving;
  state.waits_for = "b";
  hear(state);
  hear(AgentStatus{.robot = "a", .phase = Phase::driving});
  const auto behind = wait_of(robot("a"), 15);
  ASSERT_TRUE(behind);
  EXPECT_EQ(behind->cause, "it lets b go first");
  EXPECT_DOUBLE_EQ(behind->seconds, 3);
  state.promise.stamp = 16;
  state.waits_for.clear();
  state.stage = Stage::waiting;
  hear(state);
  EXPECT_EQ(wait_of(robot("a"), 16).value().cause, "it stands until there is a joint plan");
  state.promise.stamp = 17;
  state.stage = Stage::free;
  hear(state);
  EXPECT_FALSE(wait_of(robot("a"), 17));
}

TEST_F(FleetViewTest, ANewMissionClearsPathAndRootTrees) {
  hear(mission_of("a", 1));
  hear(PathMessage{"a", 1, {{0, 0}, {1, 1}}});
  hear(RootNodes{"a", 1, 0, {{Root::start, {0, 0}, -1}, {Root::start, {1, 0}, 0}}});
  hear(RootNodes{"a", 1, 1, {{Root::start, {1, 0}, 0}, {Root::goal, {2, 0}, -1}}});  // repeats one
  hear(RootNodes{"a", 1, 7, {{Root::goal, {9, 9}, -1}}});  // the nodes before it are missing
  EXPECT_EQ(robot("a").root_nodes.size(), 3u);
  const auto revision = robot("a").path_revision;
  hear(mission_of("a", 2));
  EXPECT_TRUE(robot("a").path.empty());
  EXPECT_TRUE(robot("a").root_nodes.empty());
  EXPECT_NE(robot("a").path_revision, revision);
  hear(PathMessage{"a", 1, {{0, 0}, {1, 1}}});  // it belongs to the mission before
  EXPECT_TRUE(robot("a").path.empty());
  hear(mission_of("a", 1));
  EXPECT_EQ(robot("a").mission->number, 2u);
}

TEST_F(FleetViewTest, AnotherRunOrMapClearsTheView) {
  hear(map_named("m"));
  hear(InactiveTreesMessage{{1, 1}, "m", 1, {{{0, 0}, -1, 1}}});
  hear(InactiveTreesMessage{{1, 1}, "m", 1, {{{0, 0}, -1, 1}}});
  hear(InactiveTreesMessage{{1, 2}, "other", 1, {{{0, 0}, -1, 1}}});
  EXPECT_EQ(view.inactive_trees().size(), 1u);
  hear(mission_of("a", 1));
  const auto run = view.run();
  hear(mission_of("b", 1));
  EXPECT_EQ(view.run(), run);
  hear(mission_of("b", 1, {200, 1}));
  EXPECT_GT(view.run(), run);
  ASSERT_EQ(view.robots().size(), 1u);  // this is b; a belongs to the run before
  EXPECT_EQ(view.inactive_trees().size(), 1u);
  hear(mission_of("a", 1, {100, 1}));  // this run, too, is over
  EXPECT_EQ(view.robots().size(), 1u);
  hear(map_named("other"));
  EXPECT_TRUE(view.inactive_trees().empty());
  EXPECT_TRUE(view.robots().empty());
}

// The clock was set back, or a recording is replayed from the beginning.
TEST_F(FleetViewTest, AnEarlierRunIsShownOnceTheLaterOneIsOver) {
  hear(mission_of("a", 1, {200, 1}), 210);
  RobotState state = state_of("a", 10, {1, 1});
  state.run = {200};
  hear(state, 210);
  hear(mission_of("b", 1, {100, 1}), 212);
  ASSERT_EQ(view.robots().size(), 1u);
  EXPECT_EQ(view.robots()[0].name, "a");
  Mission over = mission_of("c", 1, {100, 1});
  over.cancelled = true;
  hear(over, 220);
  EXPECT_EQ(view.robots()[0].name, "a");
  hear(mission_of("b", 1, {100, 1}), 220);
  ASSERT_EQ(view.robots().size(), 1u);
  EXPECT_EQ(view.robots()[0].name, "b");
}

TEST_F(FleetViewTest, APathThatArrivesBeforeItsMissionIsShown) {
  hear(mission_of("a", 1));
  hear(PathMessage{"a", 2, {{0, 0}, {1, 1}}});
  hear(mission_of("a", 2));
  EXPECT_EQ(robot("a").path.size(), 2u);
  hear(mission_of("a", 3));
  EXPECT_TRUE(robot("a").path.empty());
}

TEST_F(FleetViewTest, MessagesOfThePreviousRunAreNotShown) {
  hear(mission_of("a", 1));
  hear(PathMessage{"a", 1, {{0, 0}, {1, 1}}, 50});
  hear(RootNodes{"a", 1, 0, {{Root::start, {0, 0}, -1}}, 50});
  AgentStatus status{.robot = "a", .mission = 1, .phase = Phase::arrived};
  status.run = {50};
  hear(status);
  EXPECT_TRUE(robot("a").path.empty());
  EXPECT_TRUE(robot("a").root_nodes.empty());
  EXPECT_FALSE(robot("a").status);
  hear(PathMessage{"a", 1, {{0, 0}, {1, 1}}, 100});
  EXPECT_EQ(robot("a").path.size(), 2u);
}

TEST_F(FleetViewTest, ActiveTreesAreShownWhileTheirBrokerIsAlive) {
  hear(map_named("m"));
  hear(BrokerStatus{.broker = 7}, 100);
  hear(ActiveTreesMessage{7, "m", {{{0, 0}, {1, 1}}}}, 100);
  ASSERT_TRUE(view.active_trees() != nullptr);
  hear(BrokerStatus{.broker = 8}, 110);  // the other broker has been silent for long
  EXPECT_TRUE(view.active_trees() == nullptr);
}

TEST_F(FleetViewTest, TheFiguresCountTheFleet) {
  hear(mission_of("a", 1));
  hear(mission_of("b", 3));
  hear(state_of("a", 0, {0, 0}));
  hear(state_of("b", 0, {0, 5}));
  hear(PathMessage{"a", 1, {{0, 0}, {1, 1}}});
  AgentStatus status{.robot = "b", .mission = 3, .phase = Phase::arrived};
  status.trees_grafted = 4;
  status.load = {.periods = 100, .periods_missed = 10, .state_age_p50 = 0.1, .state_age_p99 = 0.5};
  status.load.processor_seconds = 1;
  hear(status, 100);
  EXPECT_LT(view.figures(100).processors, 0);  // they are not known yet
  status.load.periods = 200;
  status.load.periods_missed = 60;
  status.load.processor_seconds = 2;
  hear(status, 105);
  const FleetFigures figures = view.figures(100);
  EXPECT_EQ(figures.time, 0);
  EXPECT_EQ(figures.robots, 2u);
  EXPECT_EQ(figures.planned, 1u);
  EXPECT_EQ(figures.arrived, 1u);
  EXPECT_EQ(figures.missions, 3u);
  EXPECT_EQ(figures.trees_grafted, 4u);
  EXPECT_NEAR(figures.separation.value(), 3, 1e-12);
  EXPECT_EQ(figures.state_age_p99, 0.5);
  EXPECT_NEAR(figures.processors, 0.2, 1e-12);
  EXPECT_NEAR(robot("b").missed.of_all, 0.5, 1e-12);
  EXPECT_NEAR(figures.missed_share, 0.25, 1e-12);
}

TEST_F(FleetViewTest, TheLeastSeparationOfManyRobotsIsFound) {
  double least = 1e9;
  std::vector<Point2> places;
  for (int k = 0; k < 60; ++k) {
    places.emplace_back((k * 37) % 61 * 3.5, (k * 23) % 59 * 2.5);
    hear(state_of("r" + std::to_string(k), 0, places.back()));
  }
  hear(mission_of("r0", 1));
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = i + 1; j < places.size(); ++j)
      least = std::min(least, (places[i] - places[j]).norm() - 2);
  }
  EXPECT_NEAR(view.figures(100).separation.value(), least, 1e-12);
}

}  // namespace
}  // namespace coppice
