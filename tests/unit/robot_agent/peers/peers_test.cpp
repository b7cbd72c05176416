// Tests of what a robot knows of its peers, and of which messages it ignores.
#include <optional>

#include <gtest/gtest.h>

#include "planning/quantities.h"
#include "tests/unit/robot_agent/listener.h"

namespace coppice {
namespace {

/// Hears a robot that stands at (100, 100) in the run `run`.
bool hear(Fleet& fleet, const RobotName& robot, WallTime run, double stamp) {
  const RobotState state{.robot = robot,
                         .promise = {.stamp = stamp,
                                     .position = {100, 100},
                                     .decision_time = stamp,
                                     .next_velocity = Point2::Zero(),
                                     .expiry = stamp},
                         .radius = 5,
                         .round = {},
                         .run = {run}};
  return fleet.hear(std::make_shared<const RobotState>(state), run + stamp);
}

TEST(Peers, OnlyANewMissionOfAPeerCountsAsANewGoal) {
  Fleet fleet("a");
  Mission mission{.robot = "b", .number = 1, .clock = {}};
  fleet.hear(mission, 0);
  mission.cancelled = true;
  fleet.hear(mission, 1);
  EXPECT_EQ(fleet.new_goals(), 0u);
  mission.number = 2;
  fleet.hear(mission, 2);
  EXPECT_EQ(fleet.new_goals(), 1u);
}

TEST(Peers, ARoundDoesNotWaitForAStoppedPeer) {
  Fleet fleet("a");
  fleet.hear(Mission{.robot = "a", .clock = {}}, 0);
  const RoundId round{1, "a", {100, 100}, 50};
  const auto says = [&](const char* robot, Phase phase, double stamp) {
    RobotState state{
        .robot = robot, .promise = {.stamp = stamp, .position = {100, 100}}, .radius = 5, .round = {}};
    state.phase = phase;
    fleet.hear(std::make_shared<const RobotState>(state), stamp);
  };
  says("b", Phase::driving, 1);
  EXPECT_FALSE(fleet.all_wait(round));
  says("b", Phase::stopped, 2);
  EXPECT_TRUE(fleet.all_wait(round));
}

// Agents outlive runs. One may still send states of the last run when another has begun the next.
TEST(Peers, StatesOfThePreviousRunAreForgotten) {
  Fleet fleet("a");
  const auto says = [&](WallTime run, double stamp) { return hear(fleet, "b", run, stamp); };
  EXPECT_TRUE(says(100, 300));  // the current run is not known yet
  for (const char* robot : {"a", "b"})
    fleet.hear(Mission{.robot = robot, .start = {70, 70}, .radius = 5, .max_speed = 20, .clock = {500, 1}},
               500);
  EXPECT_EQ(fleet.find("b")->position, Point2(70, 70));
  EXPECT_FALSE(says(100, 400.1));
  EXPECT_EQ(fleet.find("b")->position, Point2(70, 70));
  EXPECT_TRUE(says(500, 0.1));
  EXPECT_EQ(fleet.find("b")->position, Point2(100, 100));
}

// An agent that was started between two runs has heard robots of the first run that are not in the second.
TEST(Peers, ARobotOutsideTheRunIsNoNeighbour) {
  Fleet fleet("a");
  for (const char* robot : {"b", "c"}) hear(fleet, robot, 100, 300);
  for (const char* robot : {"a", "b"})
    fleet.hear(Mission{.robot = robot,
                       .start = {70, 70},
                       .radius = 5,
                       .max_speed = 20,
                       .max_acceleration = 40,
                       .clock = {500, 1}},
               500);
  AgeCount ages;
  std::vector<Neighbour> near;
  fleet.collect_neighbours({80, 80}, 100, 10, 0.1, ages, near);
  ASSERT_EQ(near.size(), 1u);
  EXPECT_EQ(near.front().promise.position, Point2(70, 70));
  EXPECT_FALSE(fleet.complete());  // b has not been heard yet
  hear(fleet, "c", 100, 401);
  EXPECT_EQ(fleet.others().size(), 1u);
}

TEST(Peers, AnEchoOfAFutureStateIsIgnored) {
  Listener a;
  double now = 0;
  for (; now < 8; now += period) {
    a.hear("b", now, {{"a", 1e8, now}});
    a.hear("c", now, {{"a", std::min(now, 1.0) - 0.01, now}});
    a.judge(now);
  }
  EXPECT_FALSE(a.echoed(now));
  EXPECT_TRUE(a.cut_off());
}

TEST(Peers, AFutureEchoOfAThirdRobotIsIgnored) {
  Listener a;
  double now = 0;
  const auto go_on_until = [&](double end, std::optional<double> ahead) {
    for (; now < end; now += period) {
      std::vector<Echo> echoes{{"a", now - 0.01, now}};
      if (ahead) echoes.push_back({"b", now + *ahead, now});
      a.hear("c", now, echoes);
      a.judge(now);
    }
  };
  a.hear("b", 0, {{"a", -0.01, 0}});
  go_on_until(1.3, std::nullopt);  // b is missing
  go_on_until(1.5, 1e8);           // a false echo
  go_on_until(10, -0.1);
  EXPECT_FALSE(a.failed("b"));  // others still hear it
  EXPECT_TRUE(a.cut_off());
}

TEST(Peers, ARelayedStateReplacesNoHeardStateAndNoneIsFromTheFuture) {
  Listener a;
  for (double now = 0; now < 1; now += period) {
    a.hear("b", now, {{"a", now - 0.01, now}});
    EXPECT_FALSE(a.hear_passed_on("b", now + 0.02, now + 0.02, {10, 10}));
    a.judge(now);
  }
  EXPECT_EQ(a.place("b"), Point2(100, 100));
  EXPECT_FALSE(a.hear_passed_on("b", 1e6, 1.8, {10, 10}));
  EXPECT_TRUE(a.hear_passed_on("b", 1.1, 1.8, {90, 100}));  // b said that before it fell silent
  EXPECT_EQ(a.place("b"), Point2(90, 100));
}

/// The listener hears b for a second, and then sleeps.
void sleep_until(double wakes, Listener& a) {
  for (double now = 0; now < 1; now += period) {
    a.hear("b", now, {{"a", now - 0.01, now}});
    a.judge(now);
  }
  a.wake(wakes);
}

TEST(Peers, AfterALongSleepOnlyNewerStatesTellWherePeersAre) {
  Listener a({"b"});
  sleep_until(50, a);
  EXPECT_EQ(a.unknown(), "b");
  a.hear_passed_on("b", 40, 50.05, {90, 100});  // it lay in the socket
  a.judge(50.05);
  EXPECT_EQ(a.unknown(), "b");
  a.judge(53);
  EXPECT_FALSE(a.failed("b"));
  a.hear("b", 53.1);
  EXPECT_EQ(a.unknown(), "");
}

TEST(Peers, AfterALongSleepOthersTellWhichPeersFailed) {
  Listener a({"b"});
  sleep_until(50, a);
  RobotState last = state_of("b", 20, {90, 100});
  last.passed_on = last.counts_as_failed = true;
  a.hear(last);
  a.judge(50.1);
  EXPECT_TRUE(a.failed("b"));
  EXPECT_EQ(a.unknown(), "");
}

TEST(Peers, AFleetHoldsNoMoreThanTheLargestNumberOfRobots) {
  Listener a;
  for (std::size_t k = 0; k < 2 * most_robots; ++k) a.hear("x" + std::to_string(k), 0);
  EXPECT_EQ(a.others(), most_robots);
  a.hear("b", 1, {}, Point2::Zero(), {50, 50});  // a known robot stays
  EXPECT_EQ(a.place("b"), Point2(50, 50));
}

}  // namespace
}  // namespace coppice
