// Tests of goals that are requested over ROS during a run.
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

/// Robot a in a run from {20, 60} to {100, 60}. In ROS, y has the opposite sign.
struct UnderWay {
  explicit UnderWay(const ServiceSettings& settings = {}, const Scenario& scenario = two_robots())
      : service(scenario, settings, 0) {
    map_and_missions(service);
  }
  void drives(const char* robot, const Point2& to, double now, std::uint32_t index) {
    service.on(arrival_of(TrackMessage{robot, 1, index, {{now, to, {0, 0}}}}, now));
  }
  void says(const char* robot, std::uint32_t mission, Phase phase, double now, std::uint32_t points = 0) {
    AgentStatus status{.robot = robot, .mission = mission, .phase = phase};
    status.arrival_time = phase == Phase::arrived ? now : 0;
    status.track_points = points;
    service.on(arrival_of(status, now));
  }
  std::vector<Mission> missions(double now) { return of<Mission>(service.step(now)); }
  PlannerService service;
};

TEST(ServiceGoals, ADrivingRobotGoesToTheNewGoalFromWhereItIs) {
  UnderWay run;
  run.says("a", 1, Phase::driving, 1);
  run.drives("a", {50, 60}, 2, 0);
  EXPECT_FALSE(run.service.on(RosGoal{"a", "map", {30, -60}}));
  const auto next = run.missions(2);
  ASSERT_EQ(next.size(), 1u);
  EXPECT_EQ(next[0].robot, "a");
  EXPECT_EQ(next[0].number, 2u);
  EXPECT_EQ(next[0].start, Point2(50, 60));
  EXPECT_EQ(next[0].goal, Point2(30, 60));
  EXPECT_FALSE(next[0].cancelled);
  EXPECT_TRUE(run.missions(2.1).empty());

  // The unfinished mission does not count; the fulfilled one does. A status of the old mission is ignored.
  run.says("a", 1, Phase::arrived, 3);
  EXPECT_EQ(run.service.progress(3).missions, 0);
  run.drives("a", {30, 60}, 4, 1);
  run.says("a", 2, Phase::arrived, 4);
  EXPECT_EQ(run.service.progress(4).missions, 1);
  EXPECT_EQ(run.service.report().robots(0).missions(), 1u);
  EXPECT_TRUE(run.service.report().robots(0).arrived());
}

TEST(ServiceGoals, AnArrivedRobotHasFulfilledItsMission) {
  UnderWay run;
  run.drives("a", {100.2, 60}, 5, 0);
  run.says("a", 1, Phase::arrived, 5);
  EXPECT_FALSE(run.service.on(RosGoal{"a", "", {30, -60}}));
  const auto next = run.missions(5);
  ASSERT_EQ(next.size(), 1u);
  EXPECT_EQ(next[0].start, Point2(100, 60));
  EXPECT_EQ(run.service.progress(5).missions, 1);
}

TEST(ServiceGoals, TheLastOfSeveralGoalsCountsAndWaitsForTheMissions) {
  PlannerService service(two_robots(), {}, 0);
  service.step(0);
  EXPECT_FALSE(service.on(RosGoal{"a", "map", {30, -60}}));
  EXPECT_FALSE(service.on(RosGoal{"a", "map", {40, -60}}));
  EXPECT_TRUE(of<Mission>(service.step(0.1)).empty());
  const auto missions = of<Mission>(service.step(4));  // no broker came
  ASSERT_EQ(missions.size(), 3u);
  EXPECT_EQ(missions[2].number, 2u);
  EXPECT_EQ(missions[2].start, Point2(20, 60));
  EXPECT_EQ(missions[2].goal, Point2(40, 60));
}

TEST(ServiceGoals, AnUnreachableGoalIsRefusedAndCounted) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  UnderWay run;
  const std::vector<RosGoal> bad = {
      {"a", "map", {60, -60}},   // in the wall
      {"a", "map", {54, -60}},   // too close to the wall for a radius of 5
      {"a", "map", {30, 60}},    // not on the map, because y points up in ROS
      {"a", "odom", {30, -60}},  // another frame
      {"a", "map", {nan, -60}},  //
      {"a", "map", {20, -40}},   // the goal of b
      {"a", "map", {29, -40}},   // so close to the goal of b that they would touch
  };
  for (const RosGoal& goal : bad) EXPECT_TRUE(run.service.on(goal)) << goal.position;
  EXPECT_TRUE(run.missions(1).empty());
  EXPECT_EQ(run.service.goals_refused(), bad.size());
  EXPECT_EQ(run.service.report().goals_refused(), bad.size());
  EXPECT_TRUE(run.service.on(RosGoal{"nobody", "map", {30, -60}}));

  // The goal that b leaves is free, and its new one is taken.
  EXPECT_FALSE(run.service.on(RosGoal{"b", "map", {40, -20}}));
  EXPECT_FALSE(run.service.on(RosGoal{"a", "map", {20, -40}}));
  EXPECT_TRUE(run.service.on(RosGoal{"a", "map", {40, -20}}));
}

TEST(ServiceGoals, ExternalRobotsNeedMoreRoom) {
  Scenario roomy = two_robots();
  for (RobotTask& robot : roomy.robots) robot.tracking_tolerance = 1;
  UnderWay run({}, roomy);
  EXPECT_TRUE(run.service.on(RosGoal{"a", "map", {52.5, -60}}));  // the wall begins at 58
  EXPECT_TRUE(run.service.on(RosGoal{"a", "map", {31, -40}}));
  EXPECT_FALSE(run.service.on(RosGoal{"a", "map", {52, -60}}));
  UnderWay without;
  EXPECT_FALSE(without.service.on(RosGoal{"a", "map", {52.5, -60}}));
  EXPECT_FALSE(without.service.on(RosGoal{"a", "map", {31, -40}}));
  PlannerService service(roomy, {}, 0);
  EXPECT_EQ(of<MapMessage>(service.step(0)).at(0).radii, std::vector<double>{6});
}

TEST(ServiceGoals, AGoalWithinTheMarginOfAnObstacleIsRefused) {
  Scenario with_margin = two_robots();
  with_margin.margin = 1;
  UnderWay run({}, with_margin);
  EXPECT_TRUE(run.service.on(RosGoal{"a", "map", {52.5, -60}}));  // the wall begins at 58
  EXPECT_FALSE(run.service.on(RosGoal{"a", "map", {52, -60}}));
}

TEST(ServiceGoals, TheOrientationOfAGoalCountsForADifferentialRobot) {
  Scenario turning = two_robots();
  turning.robots[0].max_angular_speed = turning.robots[0].max_angular_acceleration = 2;
  UnderWay run({}, turning);
  EXPECT_FALSE(run.service.on(RosGoal{"a", "map", {30, -60}, 0.5}));
  EXPECT_FALSE(run.service.on(RosGoal{"b", "map", {40, -20}, 0.5}));
  const auto missions = run.missions(1);
  ASSERT_EQ(missions.size(), 2u);
  EXPECT_EQ(missions[0].goal_yaw, -0.5) << "y is down on the map, and up in ROS";
  EXPECT_EQ(missions[0].goal_yaw_tolerance, default_yaw_tolerance);
  EXPECT_EQ(missions[1].goal_yaw_tolerance, 0) << "b is holonomic";
  EXPECT_FALSE(run.service.on(RosGoal{"a", "map", {30, -50}}));
  EXPECT_EQ(run.missions(2).at(0).goal_yaw_tolerance, 0) << "any yaw";
}

TEST(ServiceGoals, TheRunGoesOnUntilAllRobotsArrivedAtTheirNewGoals) {
  UnderWay run;
  for (const char* robot : {"a", "b"}) run.says(robot, 1, Phase::arrived, 5);
  EXPECT_FALSE(run.service.on(RosGoal{"a", "map", {30, -60}}));
  EXPECT_EQ(run.missions(5).size(), 1u);
  run.says("a", 2, Phase::driving, 6);
  EXPECT_TRUE(run.missions(6).empty());
  run.says("a", 2, Phase::arrived, 7);
  const auto last = run.missions(7);
  ASSERT_EQ(last.size(), 2u);
  EXPECT_TRUE(last[0].cancelled);
  EXPECT_TRUE(run.service.on(RosGoal{"a", "map", {50, -60}}));  // too late
}

TEST(ServiceGoals, ARunThatWaitsForGoalsEndsOnRequest) {
  UnderWay run({.timeout = 20, .waits_for_goals = true});
  for (const char* robot : {"a", "b"}) run.says(robot, 1, Phase::arrived, 5);
  EXPECT_TRUE(run.missions(5).empty());
  for (const char* robot : {"a", "b"}) run.says(robot, 1, Phase::arrived, 30);
  EXPECT_TRUE(run.missions(30).empty());
  EXPECT_FALSE(run.service.on(RosGoal{"a", "map", {30, -60}}));
  EXPECT_EQ(run.missions(30.1).size(), 1u);
  run.service.interrupt();
  const auto last = run.missions(30.2);
  ASSERT_EQ(last.size(), 2u);
  EXPECT_TRUE(last[0].cancelled);
}

TEST(ServiceGoals, ARestartedServiceGoesOnWithTheGoals) {
  std::vector<Message> kept;
  PlannerService first(two_robots(), {}, 0);
  for (Message& message : map_and_missions(first)) kept.push_back(std::move(message));
  std::erase_if(kept, [](const Message& message) { return !std::holds_alternative<Mission>(message); });
  const Message track = TrackMessage{"a", 1, 0, {{2, {50, 60}, {0, 0}}}};
  first.on(arrival_of(track, 2));
  kept.push_back(track);
  first.on(RosGoal{"a", "map", {30, -60}});
  const auto second = of<Mission>(first.step(2));
  ASSERT_EQ(second.size(), 1u);
  kept.emplace_back(second[0]);
  PlannerService after(two_robots(), {}, 3);
  ASSERT_TRUE(after.recall(kept, 3));
  EXPECT_EQ(of<Mission>(after.step(3)).at(0), second[0]);
  after.on(arrival_of(AgentStatus{.robot = "a", .mission = 2, .phase = Phase::arrived}, 4));
  EXPECT_EQ(after.progress(4).missions, 1);  // the first mission was never fulfilled
}

}  // namespace
}  // namespace coppice
