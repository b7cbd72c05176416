// Tests of an agent in several runs, message by message: it stays alive or is started again in between.
#include <optional>

#include <gtest/gtest.h>

#include "tests/unit/robot_agent/agent_run.h"

namespace coppice {
namespace {

/// The mission of the next run of a standing fleet. Its service takes the robot to be at its start.
Mission staying(double epoch) {
  Mission mission = mission_of_a(epoch, {20, 60});
  mission.starts_where_it_stands = true;
  return mission;
}

TEST(AgentRuns, InTheNextRunOfAStandingFleetTheRobotStaysWhereItStands) {
  AgentRun before;
  run_until_killed_at(3, before);
  AgentRun after;
  after.restore(before.store.messages);
  after.hear(map_message(), 50);
  after.hear(staying(50), 50);
  after.run(50, 53);
  const Point2 last = of<RobotState>(before.said).back().promise.position;
  const auto states = of<RobotState>(after.said);
  ASSERT_FALSE(states.empty());
  const Point2 stands = states.front().promise.position;
  EXPECT_LT((stands - last).norm(), 20 * 20 / (2 * 40) + 3) << "where it came to rest";
  EXPECT_GT((stands - Point2(20, 60)).norm(), 10);
  EXPECT_LT((states.back().promise.position - stands).norm(), 1e-9) << "it stays";
  EXPECT_EQ(of<AgentStatus>(after.said).back().phase, Phase::arrived);
  EXPECT_EQ(track_in(after.said).front().position, stands);
}

TEST(AgentRuns, AnAgentThatOutlivesTheRunKnowsWhereItsRobotStands) {
  AgentRun agent;
  run_until_killed_at(3, agent);
  Mission over = mission_of_a(0);
  over.cancelled = true;
  agent.hear(over, 3);
  agent.run(3, 6);
  const Point2 stands = of<RobotState>(agent.said).back().promise.position;
  agent.said.clear();
  agent.hear(staying(50), 50);
  agent.run(50, 52);
  ASSERT_FALSE(of<RobotState>(agent.said).empty());
  EXPECT_LT((of<RobotState>(agent.said).front().promise.position - stands).norm(), 1e-9);
}

TEST(AgentRuns, ARobotWithoutAGoalThatStandsTooNearToAWallDrivesOutAndStaysThere) {
  AgentRun agent;
  Mission mission = staying(0);
  mission.start = mission.goal = {4.5, 60};
  agent.hear(map_message(), 0);
  agent.hear(mission, 0);
  agent.run(0, 5);
  EXPECT_EQ(of<RobotState>(agent.said).front().promise.position, Point2(4.5, 60));
  EXPECT_GE(of<RobotState>(agent.said).back().promise.position.x(), 5);
  EXPECT_EQ(of<AgentStatus>(agent.said).back().phase, Phase::arrived)
      << of<AgentStatus>(agent.said).back().reason;
}

TEST(AgentRuns, ARobotStartsWhereItsMissionSaysIfThatIsGivenOrNothingElseIsKnown) {
  AgentRun before;
  run_until_killed_at(3, before);
  AgentRun given;
  given.restore(before.store.messages);
  given.hear(map_message(), 50);
  given.hear(mission_of_a(50, {20, 60}), 50);
  given.run(50, 51);
  EXPECT_EQ(of<RobotState>(given.said).front().promise.position, Point2(20, 60));
  AgentRun anew;
  anew.hear(map_message(), 50);
  anew.hear(staying(50), 50);
  anew.run(50, 51);
  EXPECT_EQ(of<RobotState>(anew.said).front().promise.position, Point2(20, 60));
}

/// Killed once more before it has a mission to go anywhere.
TEST(AgentRuns, ARobotThatStaysStaysThroughAnotherKill) {
  AgentRun before;
  run_until_killed_at(3, before);
  AgentRun next;
  next.restore(before.store.messages);
  next.hear(map_message(), 50);
  next.hear(staying(50), 50);
  next.run(50, 52);
  const Point2 stands = of<RobotState>(next.said).back().promise.position;
  AgentRun last;
  last.restore(next.store.messages);
  last.hear(map_message(), 55);
  last.hear(staying(50), 55);
  last.run(55, 60);
  EXPECT_LT((of<RobotState>(last.said).back().promise.position - stands).norm(), 1e-9);
}

TEST(AgentRuns, TheSavedStateOfAnotherRunIsNotUsed) {
  AgentRun before;
  run_until_killed_at(3, before);
  AgentRun after;
  after.restore(before.store.messages);
  after.hear(map_message(), 106);
  after.hear(mission_of_a(106), 106);
  after.run(106, 107);
  EXPECT_EQ(of<RobotState>(after.said).front().promise.position, Point2(20, 60));
}

// The service's clock was set back, or it is another host's.
TEST(AgentRuns, TheAgentKeepsARunThatIsEarlierThanTheRunInItsJournal) {
  AgentRun before;
  before.hear(map_message(), 1000);
  before.hear(mission_of_a(1000), 1000);
  before.run(1000, 1003);
  AgentRun after;
  after.restore(before.store.messages);
  after.hear(map_message(), 106);
  after.hear(mission_of_a(106), 106);
  after.run(106, 109);
  const RobotState last = of<RobotState>(after.said).back();
  EXPECT_GT(last.promise.position.x(), 25);
  const std::optional<SavedState> saved = saved_state_of(after.store.messages);
  ASSERT_TRUE(saved.has_value());
  EXPECT_EQ(saved->mission.clock.epoch, 106);
  EXPECT_EQ(saved->track.front().position, Point2(20, 60));
  EXPECT_EQ(saved->body.position(), last.promise.position);
}

TEST(AgentRuns, TheKeeperStoresNothingOfARunThatItSkips) {
  StateKeeper keeper("a");
  Mission of_another = mission_of_a(100);
  of_another.robot = "b";
  EXPECT_EQ(keeper.heard(of_another), Keep::nothing);
  EXPECT_EQ(keeper.heard(mission_of_a(50)), Keep::nothing);
  EXPECT_EQ(keeper.heard(mission_of_a(100)), Keep::begin_anew);
  EXPECT_EQ(keeper.heard(mission_of_a(50)), Keep::nothing);
  EXPECT_EQ(keeper.heard(mission_of_a(100)), Keep::nothing);
}

// The clock of the next service is behind the clock of the last one.
TEST(AgentRuns, ALivingAgentServesAnEarlierRunOnceItsOwnRunIsOver) {
  AgentRun agent;
  agent.hear(map_message(), 1000);
  agent.hear(mission_of_a(1000), 1000);
  agent.run(1000, 1020);
  agent.hear(mission_of_a(900), 1020);
  agent.run(1020, 1021);
  EXPECT_EQ(of<AgentStatus>(agent.said).back().run, RunId{1000});
  Mission over = mission_of_a(1000);
  over.cancelled = true;
  agent.hear(over, 1021);
  agent.run(1021, 1022);
  Mission of_long_ago = mission_of_a(900);
  of_long_ago.cancelled = true;
  agent.hear(of_long_ago, 1022);
  agent.run(1022, 1023);
  EXPECT_EQ(of<AgentStatus>(agent.said).back().run, RunId{1000});
  agent.said.clear();
  agent.hear(mission_of_a(900), 1023);
  agent.run(1023, 1050);
  EXPECT_EQ(of<AgentStatus>(agent.said).back().run, RunId{900});
  EXPECT_EQ(of<AgentStatus>(agent.said).back().phase, Phase::arrived);
  const std::optional<SavedState> saved = saved_state_of(agent.store.messages);
  ASSERT_TRUE(saved.has_value());
  EXPECT_EQ(saved->mission.clock.epoch, 900);
}

TEST(AgentRuns, TheAgentRecordsNoTrackAfterTheRun) {
  AgentRun agent;
  run_until_killed_at(20, agent);
  Mission over = of<Mission>(agent.store.messages).back();
  over.cancelled = true;
  agent.hear(over, 20);
  const std::size_t kept = agent.store.messages.size();
  agent.run(20, 90);
  agent.said.clear();
  agent.run(90, 400);
  EXPECT_TRUE(of<TrackMessage>(agent.said).empty());
  EXPECT_GT(of<RobotState>(agent.said).size(), 1000u);
  EXPECT_LT(agent.store.messages.size(), kept + 20);
}

TEST(AgentRuns, ALivingAgentServesTheNextRun) {
  AgentRun agent;
  run_until_killed_at(20, agent);  // it has arrived
  agent.hear(mission_of_a(100), 100);
  agent.said.clear();
  agent.run(100, 120);
  EXPECT_EQ(of<RobotState>(agent.said).front().promise.position, Point2(20, 60));
  EXPECT_EQ(of<AgentStatus>(agent.said).back().phase, Phase::arrived);
  EXPECT_EQ(of<TrackMessage>(agent.said).front().first_index, 0u);
  const std::optional<SavedState> saved = saved_state_of(agent.store.messages);
  ASSERT_TRUE(saved.has_value());
  EXPECT_LT((saved->track.back().position - Point2(100, 60)).norm(), 1);
  EXPECT_EQ(saved->mission.clock.epoch, 100);
}

}  // namespace
}  // namespace coppice
