// Tests of the robot agent as a state machine, message by message.
#include "robot_agent/process/robot_agent.h"

#include <tuple>

#include <gtest/gtest.h>

#include "tests/unit/robot_agent/agent_run.h"

namespace coppice {
namespace {

AgentStatus last_status(RobotAgent& agent, double now) {
  const auto statuses = of<AgentStatus>(messages(agent.step(now)));
  return statuses.empty() ? AgentStatus{} : statuses.back();
}

TEST(RobotAgent, TheAgentDrivesAloneWithOnlyAService) {
  Scenario scenario = two_robots();
  scenario.robots.resize(1);
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("a");
  EXPECT_FALSE(of<AgentStatus>(messages(agent.step(0))).empty());
  for (const Message& message : map_and_missions(service)) agent.on(arrival_of(message, 0));
  const auto said = run(agent, 0, 30);
  ASSERT_GE(of<PathMessage>(said).size(), 2u);  // a path from the trees, then an optimised one
  for (const PathMessage& path : of<PathMessage>(said)) EXPECT_EQ(path.waypoints.back(), Point2(100, 60));
  EXPECT_LT(length_of(of<PathMessage>(said)[1].waypoints), length_of(of<PathMessage>(said)[0].waypoints));
  const AgentStatus last = of<AgentStatus>(said).back();
  EXPECT_EQ(last.phase, Phase::arrived);
  EXPECT_GT(last.arrival_time, 100.0 / 20);
  EXPECT_LT((of<RobotState>(said).back().promise.position - Point2(100, 60)).norm(), 1);
  // The track holds every control step once and in order.
  std::uint32_t points = 0;
  for (const TrackMessage& batch : of<TrackMessage>(said)) {
    EXPECT_EQ(batch.first_index, points);
    points += static_cast<std::uint32_t>(batch.points.size());
  }
  EXPECT_EQ(points, last.track_points);
}

TEST(RobotAgent, AnAgentThatLacksAMissionOfTheRunStandsUntilItComes) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("a");
  std::vector<Message> late;
  for (const Message& message : map_and_missions(service)) {
    const auto* const mission = std::get_if<Mission>(&message);
    if (mission != nullptr && mission->robot == "b") {
      late.push_back(message);
    } else {
      agent.on(arrival_of(message, 0));
    }
  }
  ASSERT_EQ(late.size(), 1u);
  const auto said = run(agent, 0, 40);
  EXPECT_EQ(of<RobotState>(said).back().promise.position, Point2(20, 60));
  EXPECT_EQ(of<AgentStatus>(said).back().wait_cause, "1 of 2 robots have missions by now");
  agent.on(arrival_of(late.front(), 40));
  EXPECT_GT((of<RobotState>(run(agent, 40, 140)).back().promise.position - Point2(20, 60)).norm(), 10);
}

TEST(RobotAgent, TheAgentOfASlowFleetSendsItsTrackInBatches) {
  Scenario scenario = two_robots();
  scenario.robots.resize(1);
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("a");
  for (Message message : map_and_missions(service)) {
    if (auto* mission = std::get_if<Mission>(&message)) mission->clock.scale = 0.1;
    agent.on(arrival_of(message, 0));
  }
  const auto said = run(agent, 0, 20);
  EXPECT_EQ(of<AgentStatus>(said).back().phase, Phase::driving);
  EXPECT_GT(of<AgentStatus>(said).size(), 30u) << "heartbeats in wall time";
  const auto batches = of<TrackMessage>(said);
  EXPECT_LE(batches.size(), 6u) << "for two seconds of fleet time, with two changes of phase";
  EXPECT_GT(batches.back().first_index + batches.back().points.size(), 29u);
}

TEST(RobotAgent, ACancelledMissionStopsTheRobot) {
  Scenario scenario = two_robots();
  scenario.robots.resize(1);
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("a");
  Mission mission;
  for (const Message& message : map_and_missions(service)) {
    agent.on(arrival_of(message, 0));
    if (const auto* m = std::get_if<Mission>(&message)) mission = *m;
  }
  run(agent, 0, 2);
  mission.cancelled = true;
  agent.on(arrival_of(mission, 2));
  const auto said = run(agent, 2, 4);
  EXPECT_EQ(of<AgentStatus>(said).back().phase, Phase::stopped);
  EXPECT_TRUE(of<RobotState>(said).back().promise.velocity.isZero(0));
}

// The map may belong to a run that has nothing to do with this one.
TEST(RobotAgent, ACancelledMissionStopsTheRobotAfterAnotherMapWasHeard) {
  Scenario scenario = two_robots();
  scenario.robots.resize(1);
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("a");
  Mission mission;
  for (const Message& message : map_and_missions(service)) {
    agent.on(arrival_of(message, 0));
    if (const auto* m = std::get_if<Mission>(&message)) mission = *m;
  }
  run(agent, 0, 2);
  agent.on(arrival_of(MapMessage{"elsewhere", wall_with_door(), {5}}, 2));
  mission.cancelled = true;
  agent.on(arrival_of(mission, 2));
  const auto said = run(agent, 2, 4);
  EXPECT_EQ(of<AgentStatus>(said).back().phase, Phase::stopped);
  EXPECT_TRUE(of<RobotState>(said).back().promise.velocity.isZero(0));
}

TEST(RobotAgent, TheRobotDrivesToItsNextGoalAfterAnotherMapWasHeard) {
  Scenario scenario = two_robots();
  scenario.robots.resize(1);
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("a");
  Mission mission;
  for (const Message& message : map_and_missions(service)) {
    agent.on(arrival_of(message, 0));
    if (const auto* m = std::get_if<Mission>(&message)) mission = *m;
  }
  run(agent, 0, 2);
  agent.on(arrival_of(MapMessage{"elsewhere", wall_with_door(), {5}}, 2));
  ++mission.number;
  mission.goal = {20, 40};
  agent.on(arrival_of(mission, 2));
  const auto said = run(agent, 2, 20);
  EXPECT_EQ(of<AgentStatus>(said).back().mission, 2u);
  EXPECT_EQ(of<AgentStatus>(said).back().phase, Phase::arrived);
}

TEST(RobotAgent, ARobotOnItsWayBrakesAndTurnsToItsNewGoal) {
  AgentRun alone;
  Mission mission = mission_of_a(0);
  alone.hear(map_message(), 0);
  alone.hear(mission, 0);
  alone.run(0, 2);
  const Promise turn = of<RobotState>(alone.said).back().promise;
  ASSERT_GT(turn.velocity.norm(), 15);
  alone.said.clear();
  ++mission.number;
  mission.goal = {20, 40};
  alone.hear(mission, 2);
  alone.run(2, 12);
  for (const PathMessage& path : of<PathMessage>(alone.said)) EXPECT_EQ(path.waypoints.back(), mission.goal);
  EXPECT_EQ(of<AgentStatus>(alone.said).back().phase, Phase::arrived);
  const double brakes_in = 20.0 * 20 / (2 * 40);
  for (const RobotState& state : of<RobotState>(alone.said))
    EXPECT_LT(state.promise.position.x(), turn.position.x() + brakes_in + 0.2 * 20);
}

TEST(RobotAgent, TheCountersOfTheProcessGoOnInTheNextRun) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("a");
  std::vector<Mission> missions;
  for (const Message& m : map_and_missions(service)) {
    agent.on(arrival_of(m, 0));
    if (const auto* mission = std::get_if<Mission>(&m)) missions.push_back(*mission);
  }
  std::uint32_t number = 0;
  const auto last_of_run = [&](double from, double until, WallTime epoch) {
    AgentStatus last;
    for (double now = from; now < until; now += 0.1) {
      RobotState b = state_of("b", now - epoch, {20, 30});
      b.sequence = ++number;
      b.run = {epoch};
      b.echoes = {{"a", now - epoch - 0.05, now - epoch}};
      agent.on(arrival_of(b, now));
      for (const AgentStatus& status : of<AgentStatus>(run(agent, now, now + 0.1))) last = status;
    }
    return last;
  };
  const AgentStatus first = last_of_run(0.1, 5, 0);
  EXPECT_GT(first.load.state_age_max, 0);
  for (Mission mission : missions) {
    mission.clock.epoch = 10;
    agent.on(arrival_of(mission, 10));
  }
  const AgentStatus second = of<AgentStatus>(run(agent, 10, 10.1)).back();
  EXPECT_EQ(second.run, RunId{10});
  EXPECT_GE(second.load.states_received, first.load.states_received);
  EXPECT_GE(second.load.state_age_max, first.load.state_age_max);
}

TEST(RobotAgent, AnAgentWithoutAMissionSaysSoOnceTheMissionsCame) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("r9");
  EXPECT_EQ(last_status(agent, 0).reason, "");
  for (const Message& m : map_and_missions(service)) agent.on(arrival_of(m, 1));
  const AgentStatus status = last_status(agent, 2);
  EXPECT_EQ(status.phase, Phase::waiting);
  EXPECT_EQ(status.reason, "no mission for r9: the run has 2 robots, a to b");
}

TEST(RobotAgent, TheAgentReportsItsWaitAndWhyItDidNotArrive) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("a");
  std::vector<Mission> missions;
  for (const Message& m : map_and_missions(service)) {
    agent.on(arrival_of(m, 0));
    if (const auto* mission = std::get_if<Mission>(&m)) missions.push_back(*mission);
  }
  AgentStatus status = of<AgentStatus>(run(agent, 0, 2)).back();
  EXPECT_EQ(status.phase, Phase::driving);
  EXPECT_EQ(status.wait_cause, "");
  EXPECT_GT(status.way_left, 80);
  status = of<AgentStatus>(run(agent, 2, 8)).back();
  EXPECT_EQ(status.wait_cause, "it has not heard where b is");
  EXPECT_NEAR(status.waits.startup, 7.75, 0.5);  // the last status is up to half a second old
  EXPECT_NEAR(sum_of(status.waits), status.waits.startup, 0.1);
  EXPECT_LT(status.came_on_at, 0.5);
  for (Mission mission : missions) {
    mission.cancelled = true;
    agent.on(arrival_of(mission, 8));
  }
  status = of<AgentStatus>(run(agent, 8, 9)).back();
  EXPECT_EQ(status.phase, Phase::stopped);
  EXPECT_NE(status.reason.find("it has not heard where b is"), std::string::npos) << status.reason;
  EXPECT_EQ(status.wait_cause, "");
}

TEST(RobotAgent, AnAgentWithoutOdometrySaysSo) {
  Scenario scenario = two_robots();
  scenario.robots.resize(1);
  scenario.robots[0].goal = {20, 30};
  scenario.robots[0].tracking_tolerance = 1;
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("a");
  agent.track_robot({});
  Mission mission;
  for (const Message& message : map_and_missions(service)) {
    agent.on(arrival_of(message, 0));
    if (const auto* m = std::get_if<Mission>(&message)) mission = *m;
  }
  EXPECT_EQ(of<AgentStatus>(run(agent, 0, 6)).back().wait_cause, "no odometry came");
  mission.cancelled = true;
  agent.on(arrival_of(mission, 6));
  EXPECT_EQ(of<AgentStatus>(run(agent, 6, 7)).back().reason, "since 0.0 s: no odometry came");
}

TEST(RobotAgent, AnAgentWhoseRobotMayNotBeOffItsReferenceSaysSo) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("a");
  agent.track_robot({});
  for (const Message& message : map_and_missions(service)) agent.on(arrival_of(message, 0));
  const AgentStatus status = of<AgentStatus>(run(agent, 0, 1)).back();
  EXPECT_EQ(status.phase, Phase::no_path);
  EXPECT_NE(status.reason.find("--drive ros"), std::string::npos) << status.reason;
}

TEST(RobotAgent, AnAgentThatProgressesReportsNoWait) {
  Scenario scenario = two_robots();
  scenario.robots.resize(1);
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("a");
  for (const Message& message : map_and_missions(service)) agent.on(arrival_of(message, 0));
  double left = 1e9;
  for (const AgentStatus& status : of<AgentStatus>(run(agent, 0, 30))) {
    EXPECT_EQ(status.wait_cause, "");
    EXPECT_LE(sum_of(status.waits), 0.5);  // until it has sped up, and at the goal
    if (status.way_left < 0) continue;
    EXPECT_LE(status.way_left, left + 1e-6);
    left = status.way_left;
  }
  EXPECT_EQ(left, 0);
}

TEST(RobotAgent, AnAgentThatMustStopBrakesAndSendsAllThatIsLeft) {
  Scenario scenario = two_robots();
  scenario.robots.resize(1);
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("a");
  for (const Message& message : map_and_missions(service)) agent.on(arrival_of(message, 0));
  std::uint32_t points = 0;
  for (const auto& batch : of<TrackMessage>(run(agent, 0, 2)))
    points += static_cast<std::uint32_t>(batch.points.size());
  ASSERT_FALSE(agent.stands());
  agent.retire();
  const auto said = run(agent, 2, 3);
  EXPECT_TRUE(agent.stands());
  const auto last = messages(agent.final_messages(3));
  for (const auto& messages : {said, last}) {
    for (const auto& batch : of<TrackMessage>(messages)) {
      EXPECT_EQ(batch.first_index, points);
      points += static_cast<std::uint32_t>(batch.points.size());
    }
  }
  ASSERT_EQ(of<AgentStatus>(last).size(), 1u);
  const AgentStatus status = of<AgentStatus>(last)[0];
  EXPECT_EQ(status.phase, Phase::stopped);
  EXPECT_EQ(status.reason, "the agent was told to stop");
  EXPECT_EQ(status.track_points, points);
  EXPECT_NEAR(points, 3 / 0.05, 2);
}

TEST(RobotAgent, AStandingAgentThatWakesLateIsStillHeard) {
  Scenario scenario = two_robots();
  scenario.robots.resize(1);
  PlannerService service(scenario, {}, 0);
  RobotAgent agent("a");
  for (const Message& message : map_and_missions(service)) agent.on(arrival_of(message, 0));
  run(agent, 0, 30);  // to its goal
  for (const double late : {0.0, 0.02, 0.06, 0.11}) {
    const double from = 30 + 1000 * late;
    EXPECT_GE(of<RobotState>(run(agent, from, from + 10, late)).size(), 25u) << late;
  }
}

TEST(RobotAgent, ATreeThroughAWallIsDroppedAndCounted) {
  PlannerService service(two_robots(), {}, 0);
  const auto tasks = map_and_missions(service);
  const std::string map = of<MapMessage>(tasks)[0].map_id;
  const InactiveTreesMessage sound{
      .id = {1, 0}, .map_id = map, .radius = 5, .nodes = {{{30, 30}, -1, 5}, {{40, 30}, 0, 5}}};
  InactiveTreesMessage forged = sound;
  forged.id.number = 1;
  forged.nodes[1].position = {90, 60};
  InactiveTreesMessage outside = sound;
  outside.id.number = 2;
  outside.nodes[1].position = {1e6, 60};
  RobotAgent agent("a");
  for (const Message& m : {Message(sound), Message(forged)}) agent.on(arrival_of(m, 0));  // before the map
  for (const Message& m : tasks) agent.on(arrival_of(m, 0));
  AgentStatus status = last_status(agent, 0);
  EXPECT_EQ(status.trees_received, 1u);
  EXPECT_EQ(status.rejected, 1u);
  agent.on(arrival_of(forged, 0.1));
  agent.on(arrival_of(outside, 0.1));
  status = last_status(agent, 0.6);
  EXPECT_EQ(status.trees_received, 1u);
  EXPECT_EQ(status.rejected, 3u);
}

TEST(RobotAgent, AMissionThatDoesNotFitTheMapFailsWithAReason) {
  for (const auto& [start, goal, word] : {std::tuple(Point2(20, 60), Point2(60, 60), "goal"),
                                          std::tuple(Point2(20, 60), Point2(1e8, 0), "goal"),
                                          std::tuple(Point2(60, 60), Point2(20, 60), "start"),
                                          std::tuple(Point2(-3, 60), Point2(20, 60), "start")}) {
    PlannerService service(two_robots(), {}, 0);
    RobotAgent agent("a");
    for (Message m : map_and_missions(service)) {
      if (auto* mission = std::get_if<Mission>(&m); mission != nullptr && mission->robot == "a") {
        mission->start = start;
        mission->goal = goal;
      }
      agent.on(arrival_of(m, 0));
    }
    const AgentStatus status = last_status(agent, 0);
    EXPECT_EQ(status.phase, Phase::no_path);
    EXPECT_NE(status.reason.find(word), std::string::npos) << status.reason;
    EXPECT_FALSE(
        of<RobotState>(messages(agent.step(0.1))).empty());  // the other robots must know where it stands
  }
}

TEST(RobotAgent, AMissionFarOutOfItsTimeIsIgnored) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("a");
  for (Message m : map_and_missions(service)) {
    if (auto* mission = std::get_if<Mission>(&m)) mission->clock = {0, 1000};
    agent.on(arrival_of(m, 1.7e9));
  }
  const AgentStatus status = last_status(agent, 1.7e9);
  EXPECT_EQ(status.phase, Phase::waiting);
  EXPECT_EQ(status.rejected, 2u);
}

TEST(RobotAgent, AnAgentWhoseClockWasSetStandsForThatTimeAndGoesOn) {
  PlannerService service(two_robots(), {}, 0);
  RobotAgent agent("a");
  for (const Message& m : map_and_missions(service)) {
    if (const auto* mission = std::get_if<Mission>(&m); mission != nullptr && mission->robot != "a") continue;
    agent.on(arrival_of(m, 0));
  }
  double now = 0;
  for (; now < 15; now += 0.05) agent.step(now);
  const Point2 before = agent.run()->body().position();
  now += 1e8;
  std::size_t points = 0;
  for (const TrackMessage& track : of<TrackMessage>(messages(agent.step(now)))) points += track.points.size();
  EXPECT_LT(points, 20'000u);
  EXPECT_NEAR(agent.run()->body().time(), now, 0.1);
  EXPECT_LT((agent.run()->body().position() - before).norm(), 8);  // it braked
  const AgentStatus status = last_status(agent, now + 1);
  EXPECT_GT(status.load.periods_missed, 0u);
}

}  // namespace
}  // namespace coppice
