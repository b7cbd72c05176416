// Tests of the planner service as a state machine, message by message.
#include "planner_service/run/planner_service.h"

#include <gtest/gtest.h>

#include "files/report_file.h"
#include "planner_service/run/startup_barrier.h"
#include "tests/tracks.h"
#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

TEST(PlannerService, TheServiceSendsTheMapAndThenEachMissionOnce) {
  PlannerService service(two_robots(), {}, 0);
  const auto first = service.step(0);
  ASSERT_EQ(of<MapMessage>(first).size(), 1u);
  EXPECT_EQ(of<MapMessage>(first)[0].radii, std::vector<double>{5});
  EXPECT_TRUE(of<Mission>(first).empty());
  service.on(arrival_of(BrokerStatus{.broker = 1, .trees_published = 3, .covered_map = "another map"}, 0.1));
  service.on(arrival_of(AgentStatus{.robot = "a", .trees_received = 3}, 0.1));
  EXPECT_TRUE(service.step(0.1).empty());
  service.on(arrival_of(
      BrokerStatus{.broker = 1, .trees_published = 3, .covered_map = of<MapMessage>(first)[0].map_id}, 0.1));
  EXPECT_TRUE(service.step(0.1).empty());  // b has not been heard
  service.on(arrival_of(AgentStatus{.robot = "b", .trees_received = 2}, 0.1));
  EXPECT_TRUE(service.step(0.1).empty());  // it lacks some trees

  service.on(arrival_of(AgentStatus{.robot = "b", .trees_received = 3}, 0.2));
  EXPECT_LE(service.next_wake(), 0.2);
  const auto missions = of<Mission>(service.step(0.2));
  ASSERT_EQ(missions.size(), 2u);
  EXPECT_EQ(missions[1].robot, "b");
  EXPECT_EQ(missions[0].fleet_size, 2u);
  EXPECT_NE(missions[0].seed, missions[1].seed);
  EXPECT_EQ(missions[0].clock.fleet_time(0.2), 0);
  EXPECT_TRUE(service.step(0.3).empty());
}

TEST(PlannerService, TheServiceWaitsShortlyForABrokerAndNotAtAllWithoutSharing) {
  PlannerService service(two_robots(), {}, 0);
  service.step(0);
  EXPECT_TRUE(of<Mission>(service.step(2.9)).empty());
  EXPECT_EQ(of<Mission>(service.step(3.1)).size(), 2u);

  PlannerService alone(two_robots(), {.planner = PlannerKind::rrdt_star}, 0);
  const auto first = alone.step(0);
  EXPECT_EQ(of<Mission>(first).size(), 2u);
  EXPECT_TRUE(of<MapMessage>(first)[0].radii.empty());
}

TEST(PlannerService, ARobotHasArrivedIfItsTrackShowsIt) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  const auto says = [&](const char* robot, Phase phase, std::uint32_t points) {
    AgentStatus status;
    status.robot = robot;
    status.mission = 1;
    status.phase = phase;
    status.arrival_time = 9;
    status.track_points = points;
    service.on(arrival_of(status, 1));
  };
  service.on(arrival_of(TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}, {5, {100, 60}, {0, 0}}}}, 1));
  service.on(arrival_of(TrackMessage{"b", 1, 0, {{0, {20, 20}, {0, 0}}}}, 1));
  says("a", Phase::arrived, 2);
  says("b", Phase::arrived, 1);  // it has not left its start
  const auto last = of<Mission>(service.step(1));
  ASSERT_EQ(last.size(), 2u);
  EXPECT_TRUE(last[0].cancelled);
  says("a", Phase::stopped, 2);
  says("b", Phase::stopped, 1);
  service.step(1.1);
  ASSERT_TRUE(service.finished());
  const proto::Report report = service.report();
  EXPECT_TRUE(report.robots(0).arrived());
  EXPECT_FALSE(report.robots(1).arrived());
  EXPECT_EQ(report.outcome(), "incomplete");
}

TEST(PlannerService, ARunEndsWhenAllStandAndPassingAGoalIsNotArriving) {
  PlannerService service(two_robots(), {.timeout = 2}, 0);
  map_and_missions(service);
  const auto says = [&](const char* robot, Phase phase, std::uint32_t points) {
    AgentStatus status{.robot = robot, .mission = 1, .phase = phase};
    status.track_points = points;
    service.on(arrival_of(status, 2));
  };
  for (const char* robot : {"a", "b"}) says(robot, Phase::driving, 0);
  EXPECT_TRUE(of<Mission>(service.step(2.3)).at(0).cancelled);
  service.on(arrival_of(TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}, {2, {100, 60}, {8, 0}}}}, 2.3));
  service.on(arrival_of(
      TrackMessage{"b", 1, 0, {{0, {20, 20}, {0, 0}}, {1.2, {20, 40}, {0, 0}}, {2, {20, 40}, {0, 0}}}}, 2.3));
  says("a", Phase::stopped, 2);
  says("b", Phase::stopped, 3);
  service.step(2.4);
  EXPECT_FALSE(service.finished());
  EXPECT_FALSE(service.everybody_arrived());
  service.on(arrival_of(TrackMessage{"a", 1, 2, {{2.2, {100.8, 60}, {0, 0}}}}, 2.5));
  service.step(2.6);
  ASSERT_TRUE(service.finished());
  const proto::Report report = service.report();
  EXPECT_TRUE(report.robots(0).arrived());
  EXPECT_DOUBLE_EQ(report.robots(0).run_time(), 2.2);  // when it stood, not when it passed
  EXPECT_TRUE(report.robots(1).arrived());
  EXPECT_DOUBLE_EQ(report.robots(1).run_time(), 1.2);
}

TEST(PlannerService, TheTrackOfAKilledAgentIsCompletedUpToNow) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  service.on(arrival_of(TrackMessage{"b", 1, 0, {{0, {20, 20}, {0, 0}}}}, 1));
  service.on(arrival_of(TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}, {1, {20, 55}, {0, -20}}}}, 1));
  const TrackMessage rest{
      "a", 1, 1, {{1, {20, 55}, {0, -20}}, {2, {20, 35}, {0, -10}}, {3, {20, 25}, {0, 0}}}};
  service.complete(rest, 2.5);  // it still brakes
  EXPECT_EQ(service.report().collisions(), 0u);
  EXPECT_DOUBLE_EQ(service.report().robots(0).driven_length(), 25);
  service.complete(rest, 4);  // it touches b as it comes to stand
  EXPECT_EQ(service.report().collisions(), 1u);
  EXPECT_DOUBLE_EQ(service.report().robots(0).driven_length(), 35);
}

TEST(PlannerService, ARobotWhoseTrackEndsInMotionIsNotTakenToStandThere) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  const auto say = [&](double now) {
    service.on(arrival_of(AgentStatus{.robot = "a", .mission = 1, .phase = Phase::driving}, now));
  };
  say(1);
  service.on(arrival_of(TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}, {1, {20, 55}, {0, -20}}}}, 1));
  service.on(arrival_of(
      TrackMessage{"b", 1, 0, {{0, {20, 20}, {0, 0}}, {5, {20, 20}, {0, 0}}, {9, {20, 60}, {0, 0}}}}, 9));
  const proto::Report report = service.report();
  EXPECT_EQ(report.collisions(), 0u);
  EXPECT_GT(report.least_separation(), 20);
}

TEST(PlannerService, TheReportGivesTheLengthOfThePathFromTheStart) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  const auto path = [&](const Path& waypoints) {
    service.on(arrival_of(PathMessage{"a", 1, waypoints}, 1));
    return service.report().robots(0).path_length();
  };
  EXPECT_DOUBLE_EQ(path({{20, 60}, {20, 100}, {100, 100}}), 120);
  EXPECT_DOUBLE_EQ(path({{20, 60}, {20, 100}}), 40);  // a shorter path
  EXPECT_DOUBLE_EQ(path({{50, 60}, {20, 100}}), 40);  // a path from where it was pushed to
}

TEST(PlannerService, TheServiceGivesNewGoalsWhileTheRunIsLifelong) {
  PlannerService service(two_robots(), {.lifelong = 10}, 0);
  map_and_missions(service);
  const auto arrives = [&](std::uint32_t mission, double time) {
    service.on(arrival_of(AgentStatus{.robot = "a", .mission = mission, .phase = Phase::arrived}, time));
    return of<Mission>(service.step(time));
  };
  const std::vector<Mission> next = arrives(1, 5);
  ASSERT_EQ(next.size(), 1u);
  EXPECT_EQ(next[0].robot, "a");
  EXPECT_EQ(next[0].number, 2u);
  EXPECT_FALSE(next[0].cancelled);
  const RobotTask before = two_robots().robots[0];
  EXPECT_GT((next[0].goal - before.goal).norm(), before.radius);
  EXPECT_TRUE(arrives(1, 6).empty());  // a status of the previous mission is ignored
  EXPECT_EQ(arrives(2, 7).size(), 1u);
  EXPECT_TRUE(arrives(3, 11).empty());         // the time is over
  EXPECT_EQ(service.report().missions(), 2u);  // the last mission has no track
}

/// Two robots at one end of a corridor of so many cells. Their goals are their starts.
Scenario corridor(int cells) {
  Scenario scenario;
  scenario.map = {
      .width = cells, .height = 1, .blocked = std::vector<std::uint8_t>(static_cast<std::size_t>(cells), 0)};
  scenario.robots = {{"a", {0.5, 0.5}, {0.5, 0.5}, 0.4, 1, 2, 0.1},
                     {"b", {1.5, 0.5}, {1.5, 0.5}, 0.4, 1, 2, 0.1}};
  return scenario;
}

/// Both robots arrive at once at each goal until the run has ended.
void run_in_corridor(PlannerService& service, const Scenario& scenario) {
  map_and_missions(service);
  std::map<std::string, Mission> sent;
  for (const RobotTask& task : scenario.robots) sent[task.name] = {.number = 1, .goal = task.goal};
  bool ended = false;
  for (double now = 1; !service.finished() && now < 20; now += 1) {
    for (const auto& [name, mission] : sent) {
      const AgentStatus status{.robot = name, .mission = mission.number, .phase = Phase::arrived};
      if (!ended) service.on(arrival_of(status, now));
    }
    for (const Mission& mission : of<Mission>(service.step(now))) {
      sent[mission.robot] = mission;
      ended = mission.cancelled;
    }
    for (const auto& [name, mission] : sent) {
      const auto index = static_cast<std::uint32_t>(now) - 1;
      service.on(arrival_of(TrackMessage{name, mission.number, index, {{now, mission.goal, {0, 0}}}}, now));
      AgentStatus status{.robot = name, .mission = mission.number, .phase = Phase::stopped};
      status.track_points = index + 1;
      if (ended) service.on(arrival_of(status, now));
    }
  }
}

TEST(PlannerService, ALifelongRunWithoutAFreeGoalSaysSoAndIsNoSuccess) {
  PlannerService service(corridor(2), {.lifelong = 10}, 0);
  run_in_corridor(service, corridor(2));
  ASSERT_TRUE(service.finished());
  EXPECT_TRUE(service.everybody_arrived());
  EXPECT_FALSE(service.succeeded());
  EXPECT_EQ(service.robots_without_goal().size(), 2u);
  const proto::Report report = service.report();
  EXPECT_EQ(report.outcome(), "incomplete");
  EXPECT_EQ(report.robots_without_goal(), 2u);
  EXPECT_TRUE(report.robots(0).arrived());
  EXPECT_EQ(report.robots(0).reason(), "gets no new goal: other robots take all 2 places that it can go to");
  EXPECT_NE(report_table(report).find("robots that arrived and got no new goal: 2"), std::string::npos);
}

TEST(PlannerService, ALifelongRunInWhichAllGetNewGoalsIsASuccess) {
  PlannerService service(corridor(5), {.lifelong = 10}, 0);
  run_in_corridor(service, corridor(5));
  ASSERT_TRUE(service.finished());
  EXPECT_TRUE(service.succeeded());
  const proto::Report report = service.report();
  EXPECT_EQ(report.outcome(), "arrived");
  EXPECT_EQ(report.robots_without_goal(), 0u);
  EXPECT_GE(report.missions(), 10u);
  EXPECT_EQ(report_table(report).find("no new goal"), std::string::npos);
}

TEST(PlannerService, ARunEndsAtTheTimeoutAndNamesTheMissingRobots) {
  PlannerService service(two_robots(), {.time_scale = 10, .timeout = 20}, 0);
  map_and_missions(service);
  service.step(1.9);
  EXPECT_FALSE(service.finished());
  service.step(2.1);
  service.step(6);
  EXPECT_TRUE(service.finished());
  EXPECT_EQ(service.report().outcome(), "timeout");
  EXPECT_EQ(service.report().robots(0).reason(), "its agent came, but has not taken up its mission");
}

// Otherwise agents would leave the run of another service for one that ends at once.
TEST(PlannerService, ARunInterruptedBeforeItBeganSendsNothing) {
  PlannerService service(two_robots(), {}, 0);
  service.interrupt();
  for (double now = 0; now < 10; now += 0.5) EXPECT_TRUE(service.step(now).empty());
  EXPECT_TRUE(service.finished());
  EXPECT_EQ(service.report().outcome(), "interrupted");
  EXPECT_EQ(service.report().robots(0).reason(), "the run was interrupted before it began");
}

TEST(PlannerService, TheReportSaysWhyEachRobotDidNotArrive) {
  Scenario scenario = two_robots();
  scenario.robots.push_back({"c", {20, 40}, {100, 20}, 5, 20, 40, 1});
  PlannerService service(scenario, {.timeout = 20}, 0);
  service.step(0);
  service.step(4);  // the missions, because no broker came
  AgentStatus a{.robot = "a", .mission = 1, .phase = Phase::driving, .run = {4}, .way_left = 12.34};
  service.on(arrival_of(PathMessage{"a", 1, {{20, 60}, {100, 60}}, 4}, 5));
  AgentStatus b{.robot = "b", .mission = 1, .phase = Phase::driving, .run = {4}};
  b.reason = "since 7.0 s: no odometry came";
  for (double now = 5; now < 26; now += 0.5) {
    if (now > 24) a.phase = b.phase = Phase::stopped;
    service.on(arrival_of(a, now));
    service.on(arrival_of(b, now));
    service.step(now);
  }
  EXPECT_EQ(service.report().outcome(), "timeout");
  EXPECT_EQ(service.report().robots(0).reason(),
            "the time was over while it was under way, 12.3 m from its goal");
  EXPECT_EQ(service.report().robots(1).reason(), "since 7.0 s: no odometry came");
  EXPECT_EQ(service.report().robots(2).reason(), "its agent never came");
}

// Agents outlive runs, and their processes count from their own start.
TEST(PlannerService, MissedControlPeriodsAreCountedForThisRunOnly) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  const auto says = [&](const char* robot, std::uint32_t periods, std::uint32_t missed) {
    AgentStatus status{.robot = robot, .mission = 1, .phase = Phase::driving};
    status.load = {.periods = periods, .periods_missed = missed};
    service.on(arrival_of(status, 1));
  };
  says("a", 1000, 900);
  says("b", 1, 0);
  EXPECT_EQ(service.progress(1).periods_missed, 0);
  says("a", 1060, 910);
  says("b", 41, 10);
  EXPECT_NEAR(service.progress(1).periods_missed, 0.2, 1e-9);
  says("b", 10, 0);  // it was restarted
  says("b", 110, 0);
  EXPECT_NEAR(service.report().periods_missed(), 0.1, 1e-9);
}

TEST(PlannerService, TrackPointsFromAnotherTimeAreIgnored) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  service.on(arrival_of(TrackMessage{"a", 1, 0, {{1, {20, 60}, {0, 0}}}}, 1));
  service.on(arrival_of(TrackMessage{"b", 1, 0, {{0, {20, 20}, {0, 0}}, {1e9, {20, 20}, {0, 0}}}}, 1));
  service.on(arrival_of(TrackMessage{"b", 1, 0, {{-1e9, {20, 20}, {0, 0}}}}, 1));
  EXPECT_TRUE(test::all_points(service.tracks())[1].empty());
  EXPECT_FALSE(service.report().has_least_separation());  // without a look at each of a billion seconds
}

/// Sends a status of each robot every 0.5 s, and steps the service.
void live(PlannerService& service, const std::vector<const char*>& robots, double from, double until) {
  for (double now = from; now <= until; now += 0.5) {
    for (const char* robot : robots) service.on(arrival_of(AgentStatus{.robot = robot, .mission = 1}, now));
    service.step(now);
  }
}

std::string reason_of(const PlannerService& service, int robot) {
  return service.report().robots(robot).reason();
}

TEST(PlannerService, ASilentAgentIsLostAndTheRunGoesOn) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  live(service, {"a", "b"}, 0, 3);
  live(service, {"a"}, 3.5, 7.5);
  EXPECT_NE(reason_of(service, 1), "the agent has fallen silent");
  live(service, {"a"}, 8, 9);
  EXPECT_EQ(reason_of(service, 1), "the agent has fallen silent");
  EXPECT_FALSE(service.finished());
}

// Without its journal, the agent assumes that its robot stands at its start.
TEST(PlannerService, AnAgentThatRestartsItsTrackIsStoppedAndHasNotArrived) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  const Point2 goal = two_robots().robots[0].goal;
  live(service, {"a", "b"}, 0, 3);
  service.on(arrival_of(TrackMessage{"a", 1, 0, {{0.25, {20, 60}, {0, 0}}, {2, {60, 60}, {0, 0}}}}, 3));
  // A restart with a journal: the agent repeats the points and continues.
  service.on(arrival_of(
      TrackMessage{"a", 1, 0, {{0.25, {20, 60}, {0, 0}}, {2, {60, 60}, {0, 0}}, {3, {70, 60}, {0, 0}}}}, 3));
  EXPECT_TRUE(of<Mission>(service.step(3)).empty());
  service.on(arrival_of(
      TrackMessage{"a",
                   1,
                   0,
                   {{3, {20, 60}, {0, 0}}, {4, {25, 60}, {0, 0}}, {5, {30, 60}, {0, 0}}, {6, goal, {0, 0}}}},
      3));
  const auto missions = of<Mission>(service.step(3.1));
  ASSERT_EQ(missions.size(), 2u);
  EXPECT_TRUE(missions[0].cancelled);
  EXPECT_FALSE(missions[1].cancelled);
  EXPECT_TRUE(of<Mission>(service.step(3.2)).empty());
  const proto::Report report = service.report();
  EXPECT_FALSE(report.robots(0).arrived());
  EXPECT_NE(report.robots(0).reason().find("started anew without its journal"), std::string::npos);
}

// Found by `coppice fuzz --replay 440082 --restarts`: an agent heard of the cancelled mission of a peer
// before its own, and drove on for a moment.
TEST(PlannerService, TheReasonOfAFailureIsKeptAfterTheEnd) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  const auto says = [&](const char* robot, Phase phase, const char* reason) {
    AgentStatus status;
    status.robot = robot;
    status.mission = 1;
    status.phase = phase;
    status.reason = reason;
    service.on(arrival_of(status, 1));
  };
  says("a", Phase::no_path, "shut in");
  says("b", Phase::no_path, "held up");
  EXPECT_EQ(of<Mission>(service.step(1)).size(), 2u);
  says("a", Phase::driving, "");
  says("a", Phase::stopped, "");
  says("b", Phase::stopped, "held up");
  EXPECT_EQ(reason_of(service, 0), "shut in");
  EXPECT_EQ(reason_of(service, 1), "held up");
}

TEST(PlannerService, AllAgentsSilentAtOnceAreWaitedForLonger) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  live(service, {"a", "b"}, 0, 3);
  live(service, {}, 3.5, 32);
  EXPECT_FALSE(service.finished());
  EXPECT_NE(reason_of(service, 0), "the agent has fallen silent");
  live(service, {}, 32.5, 62);
  EXPECT_EQ(reason_of(service, 0), "the agent has fallen silent");
  EXPECT_FALSE(service.finished());  // it may still return
  live(service, {}, 62.5, 67);
  EXPECT_TRUE(service.finished());
}

// The agents may be restarted at once. But a run must not wait for agents that were stopped on purpose.
TEST(PlannerService, StoppedAgentsAreWaitedForAFewSecondsOnly) {
  PlannerService service(two_robots(), {}, 0);
  map_and_missions(service);
  live(service, {"a", "b"}, 0, 3);
  for (const char* robot : {"a", "b"}) {
    AgentStatus last{.robot = robot, .mission = 1, .phase = Phase::stopped, .reason = "told to stop"};
    service.on(arrival_of(last, 3));
  }
  live(service, {}, 3.5, 7.5);
  EXPECT_FALSE(service.finished());
  live(service, {}, 8, 12);
  EXPECT_TRUE(service.finished());
  EXPECT_EQ(reason_of(service, 0), "told to stop");
}

// Agents outlive their service. DDS delivers their last statuses and their tracks to the next service.
TEST(PlannerService, StatusesOfThePreviousRunAreIgnored) {
  PlannerService service(two_robots(), {}, 100);
  const WallTime before = 50;
  const auto says_what_it_said = [&](const char* robot, const Point2& start, const Point2& goal) {
    AgentStatus status{.robot = robot, .mission = 1, .phase = Phase::arrived};
    status.path_time = 3;
    status.track_points = 2;
    status.run = {before};
    service.on(
        arrival_of(TrackMessage{robot, 1, 0, {{0.05, start, {0, 0}}, {9, goal, {0, 0}}}, before}, 101));
    service.on(arrival_of(PathMessage{robot, 1, {start, goal}, before}, 101));
    service.on(arrival_of(RootNodes{robot, 1, 0, {{Root::start, start, -1}}, before}, 101));
    service.on(arrival_of(status, 101));
  };
  const auto all_say_it = [&] {
    for (const RobotTask& task : two_robots().robots)
      says_what_it_said(task.name.c_str(), task.start, task.goal);
  };
  service.step(100);
  all_say_it();
  EXPECT_EQ(of<Mission>(service.step(104)).size(), 2u);  // no broker came
  all_say_it();
  EXPECT_TRUE(of<Mission>(service.step(104.1)).empty());  // no track begins again, and no run is over
  EXPECT_FALSE(service.finished());
  EXPECT_EQ(service.progress(104.1).planned, 0);
  EXPECT_EQ(service.progress(104.1).arrived, 0);
  EXPECT_EQ(service.report().plan_time(), 0);
  EXPECT_FALSE(service.report().has_least_clearance());  // there is no track

  service.on(arrival_of(TrackMessage{"a", 1, 0, {{0.05, {20, 60}, {0, 0}}}, 104}, 104.2));
  EXPECT_EQ(test::all_points(service.tracks())[0].size(), 1u);
}

TEST(PlannerService, MessagesSentWhileTheServiceSleptAreStillHeard) {
  PlannerService service(two_robots(), {.timeout = 1e6}, 0);
  map_and_missions(service);
  live(service, {"a", "b"}, 0, 3);
  service.step(1000);
  EXPECT_FALSE(service.finished());
  live(service, {}, 1000.5, 1004);
  live(service, {"a", "b"}, 1004.5, 1010);
  EXPECT_FALSE(service.finished());
  EXPECT_NE(reason_of(service, 0), "the agent has fallen silent");
}

TEST(StartupBarrier, TheBarrierKeepsTheLastStatusOfEachAgentAndAllElse) {
  StartupBarrier startup_barrier;
  for (std::uint32_t others = 0; others < 3; ++others) {
    for (const char* robot : {"a", "b"}) {
      AgentStatus status{.robot = robot};
      status.load.agents_matched = robot[0] == 'a' ? others : 0;
      startup_barrier.add(arrival_of(status, others));
    }
    startup_barrier.add(arrival_of(BrokerStatus{.broker = others}, others));
  }
  EXPECT_EQ(startup_barrier.agents_that_discovered(0), 2u);
  EXPECT_EQ(startup_barrier.agents_that_discovered(2), 1u);
  EXPECT_EQ(startup_barrier.agents_that_discovered(3), 0u);
  int statuses = 0;
  int brokers = 0;
  startup_barrier.for_each([&](const Arrival& arrival) {
    statuses += std::holds_alternative<AgentStatus>(*arrival.message) && arrival.at == 2;
    brokers += std::holds_alternative<BrokerStatus>(*arrival.message);
  });
  EXPECT_EQ(statuses, 2);
  EXPECT_EQ(brokers, 3);
}

}  // namespace
}  // namespace coppice
