// Tests of a restarted agent as a state machine, message by message: the process was killed and a successor
// takes over.
#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/robot_agent/agent_run.h"

namespace coppice {
namespace {

TEST(AgentRestart, ARestartedAgentGoesOnFromWhereItsRobotStopped) {
  AgentRun before;
  run_until_killed_at(3, before);
  const RobotState last = of<RobotState>(before.said).back();
  ASSERT_GT(last.promise.velocity.norm(), 5);  // it drives

  AgentRun after;
  after.restore(before.store.messages);
  after.hear(map_message(), 6);
  after.hear(mission_of_a(0), 6);
  after.run(6, 20);
  EXPECT_EQ(of<AgentStatus>(after.said).back().phase, Phase::arrived);
  const RobotState first = of<RobotState>(after.said).front();
  EXPECT_GT(first.sequence, last.sequence);
  EXPECT_TRUE(first.promise.velocity.isZero(0));
  EXPECT_LT((first.promise.position - last.promise.position).norm(), 20 * 20 / (2 * 40) + 3);

  // The track goes from the start to the goal without a gap and within the robot's limits.
  const std::vector<TrackMessage::Point> track = track_in(after.said);
  EXPECT_EQ(track.front().position, Point2(20, 60));
  EXPECT_LT((track.back().position - Point2(100, 60)).norm(), 1);
  for (std::size_t k = 1; k < track.size(); ++k) {
    ASSERT_NEAR(track[k].time - track[k - 1].time, 0.05, 1e-6);
    ASSERT_LT((track[k].position - track[k - 1].position - 0.05 * track[k - 1].velocity).norm(), 1e-9);
    ASSERT_LE((track[k].velocity - track[k - 1].velocity).norm(), 40 * 0.05 + 1e-9);
  }
  // The successor repeats what the agent said before it was killed.
  const auto said_before = of<TrackMessage>(before.said);
  ASSERT_FALSE(said_before.empty());
  for (const TrackMessage& batch : said_before) {
    for (std::size_t k = 0; k < batch.points.size(); ++k)
      ASSERT_EQ(batch.points[k], track[batch.first_index + k]);
  }
  const AgentStatus status = of<AgentStatus>(after.said).back();
  EXPECT_EQ(status.path_time, of<AgentStatus>(before.said).back().path_time);
}

// The numbers of reservations grow with fleet time. Two processes, one after the other, used the same ones
// before fleet time 0. Others drove by the reservation that the first one had made, and two robots touched.
TEST(AgentRestart, AnAgentWhoseClockIsBehindReservesNothingBeforeItsFirstState) {
  AgentRun behind;
  behind.hear(map_message(), -5);
  behind.hear(mission_of_a(0), -5);
  behind.run(-5, -0.1);
  EXPECT_TRUE(of<RobotState>(behind.said).empty());
  EXPECT_TRUE(of<ReservationMessage>(behind.said).empty());
  behind.run(-0.1, 2);
  EXPECT_FALSE(of<ReservationMessage>(behind.said).empty());
}

TEST(AgentRestart, AnAgentThatIsKilledRepeatedlyArrives) {
  auto life = std::make_unique<AgentRun>();
  run_until_killed_at(1.5, *life);
  double now = 2;
  for (int k = 0; k < 6; ++k) {
    auto next = std::make_unique<AgentRun>();
    next->restore(life->store.messages);
    next->hear(map_message(), now);
    next->hear(mission_of_a(0), now);
    next->run(now, now + 2.5);
    now += 2.6;
    life = std::move(next);
  }
  EXPECT_EQ(of<AgentStatus>(life->said).back().phase, Phase::arrived);
}

// The part of the track that was not sent yet shows that the robot stands.
TEST(AgentRestart, AnAgentKilledAtTheEndOfTheRunReportsWhereItsRobotStands) {
  AgentRun before;
  run_until_killed_at(4, before);
  for (double now = 4; of<AgentStatus>(before.said).back().phase != Phase::arrived; now += 0.01)
    before.run(now, now + 0.01);
  ASSERT_FALSE(track_in(before.said).back().velocity.isZero(0));

  AgentRun after;
  after.restore(before.store.messages);
  after.hear(map_message(), 20);
  Mission over = mission_of_a(0);
  over.cancelled = true;
  after.hear(over, 20);
  after.run(20, 23);
  EXPECT_EQ(of<AgentStatus>(after.said).back().phase, Phase::stopped);
  const std::vector<TrackMessage::Point> track = track_in(after.said);
  ASSERT_FALSE(track.empty());
  EXPECT_EQ(track.front().position, Point2(20, 60));
  EXPECT_TRUE(track.back().velocity.isZero(0));
  EXPECT_LT((track.back().position - Point2(100, 60)).norm(), 1);
}

TEST(AgentRestart, TheRestOfTheTrackIsThatWithWhichARestartedAgentGoesOn) {
  for (const double killed_at : {0.4, 1.9, 2.85, 3.0, 3.1, 3.77}) {
    AgentRun before;
    run_until_killed_at(killed_at, before);
    const TrackMessage rest = before.agent.run()->rest_of_track().value();
    const std::size_t sent = track_in(before.said).size();
    EXPECT_LE(rest.first_index, sent);
    EXPECT_TRUE(rest.points.back().velocity.isZero(0));

    AgentRun after;
    after.restore(before.store.messages);
    after.hear(map_message(), 8);
    after.hear(mission_of_a(0), 8);
    after.run(8, 9);
    const std::vector<TrackMessage::Point> track = track_in(after.said);
    for (std::size_t k = 0; k < rest.points.size(); ++k) {
      const std::size_t index = rest.first_index + k;
      ASSERT_LT(index, track.size());
      ASSERT_NEAR(rest.points[k].time, track[index].time, 1e-9) << killed_at;
      ASSERT_LT((rest.points[k].position - track[index].position).norm(), 1e-9) << killed_at;
    }
  }
}

void expect_same(const std::optional<SavedState>& one, const std::optional<SavedState>& other) {
  ASSERT_EQ(one.has_value(), other.has_value());
  if (!one) return;
  EXPECT_EQ(one->mission, other->mission);
  EXPECT_EQ(one->body.promise(), other->body.promise());
  EXPECT_EQ(one->track, other->track);
  EXPECT_EQ(one->first_index, other->first_index);
  EXPECT_NEAR(one->driven_length, other->driven_length, 1e-9);
  EXPECT_EQ(one->sequence, other->sequence);
  EXPECT_EQ(one->round_epoch, other->round_epoch);
  EXPECT_EQ(one->stage, other->stage);
  EXPECT_TRUE(same_progress(one->status, other->status));
  ASSERT_EQ(one->silent.size(), other->silent.size());
  for (std::size_t k = 0; k < one->silent.size(); ++k)
    EXPECT_EQ(one->silent[k].state, other->silent[k].state);
}

// Whenever the journal is rewritten.
TEST(AgentRestart, ARewrittenJournalSaysWhatAllMessagesSaid) {
  Mission a = mission_of_a(0);
  Mission b = a;
  a.fleet_size = b.fleet_size = 2;
  b.robot = "b";
  b.start = b.goal = {20, 20};
  AgentRun run;
  for (const Mission& mission : {a, b}) run.hear(mission, 0);
  run.hear(map_message(), 0);
  run.run(0, 90, 1);  // b dies, and is passed on
  const std::vector<Message>& all = run.store.messages;
  ASSERT_GT(all.size(), 100u);
  const std::optional<SavedState> whole = saved_state_of(all);
  for (std::size_t k = 0; k <= all.size(); k += k < 20 ? 1 : all.size() / 23) {
    StateKeeper keeper("a");
    keeper.restore(std::span(all).first(k));
    const std::vector<Message> rewritten = keeper.snapshot();
    EXPECT_LT(rewritten.size(), 10u);
    expect_same(saved_state_of(rewritten), saved_state_of(std::span(all).first(k)));
    // The process goes on, or its successor does.
    std::vector<Message> kept = rewritten;
    kept.insert(kept.end(), all.begin() + static_cast<std::ptrdiff_t>(k), all.end());
    expect_same(saved_state_of(kept), whole);
    StateKeeper successor("a");
    successor.restore(rewritten);
    EXPECT_EQ(successor.snapshot(), rewritten);
  }
}

TEST(AgentRestart, AnAgentThatDroveForLongSendsTheEndOfItsTrackAgain) {
  AgentRun before;
  before.hear(map_message(), 0);
  before.hear(mission_of_a(0), 0);
  before.run(0, 60);
  const std::vector<TrackMessage::Point> earlier = track_in(before.said);
  ASSERT_GT(earlier.size(), 1000u);
  AgentRun after;
  after.restore(before.store.messages);
  after.hear(map_message(), 62);
  after.hear(mission_of_a(0), 62);
  after.run(62, 63);
  const TrackMessage first = of<TrackMessage>(after.said).front();
  EXPECT_GT(first.first_index, earlier.size() - 300);
  EXPECT_LT(first.first_index, earlier.size());
  for (std::size_t k = first.first_index; k < earlier.size(); ++k)
    EXPECT_EQ(first.points.at(k - first.first_index), earlier[k]);
}

TEST(AgentRestart, AnAgentKilledTwiceRemembersItsPartInAJointPlan) {
  RobotState state = state_of("a", 1, {20, 60});
  state.round = {7, "b", {20, 60}, 30};
  state.stage = Stage::executing;
  std::vector<Message> kept{mission_of_a(0), state};
  state = state_of("a", 5, {20, 60});
  state.is_new = true;
  kept.emplace_back(state);
  state.is_new = false;  // but it waits for its robot, which follows it, before it calls a round
  kept.emplace_back(state);
  EXPECT_EQ(saved_state_of(kept)->stage, Stage::executing);
  EXPECT_EQ(saved_state_of(kept)->round_epoch, 7u);
  state.round = {8, "a", {20, 60}, 30};
  kept.emplace_back(state);
  EXPECT_EQ(saved_state_of(kept)->stage, Stage::free);
}

TEST(AgentRestart, TheTrackLeavesOutThePauseThatThePredecessorLeftOut) {
  AgentRun first;
  run_until_killed_at(3, first);
  ASSERT_GT(of<RobotState>(first.said).back().promise.velocity.norm(), 5);  // it brakes, and then it stands
  std::vector<Message> kept = first.store.messages;
  std::vector<TrackMessage::Point> before = track_in(first.said);
  for (const double woken : {700.0, 703.0}) {
    AgentRun next;
    next.restore(kept);
    next.hear(map_message(), woken);
    next.hear(mission_of_a(0), woken);
    next.run(woken, woken + 2);
    const std::vector<TrackMessage::Point> track = track_in(next.said);
    ASSERT_GT(track.size(), before.size());
    for (std::size_t k = 0; k < before.size(); ++k) ASSERT_EQ(track[k], before[k]) << k;
    EXPECT_GT(track.back().time, woken);
    EXPECT_LT(track.size(), 200u);
    before = track;
    kept = next.store.messages;
  }
}

TEST(AgentRestart, TheTrackBeginsWithTheFirstState) {
  AgentRun before;
  before.hear(map_message(), 7.03);
  before.hear(mission_of_a(0), 7.03);
  before.run(7.13, 9);  // late
  AgentRun after;
  after.restore(before.store.messages);
  after.hear(map_message(), 10);
  after.hear(mission_of_a(0), 10);
  after.run(10, 11);
  EXPECT_EQ(track_in(before.said).front().time, of<RobotState>(before.said).front().promise.stamp);
  EXPECT_EQ(track_in(after.said).front(), track_in(before.said).front());
}

/// Two robots are in the run. Robot b dies at 1 s; the agent of a is killed at 3 s and restarted at 5 s.
AgentStatus last_status_of_one_alone(bool keeps_what_it_passed_on, bool b_is_cancelled = false) {
  Mission a = mission_of_a(0);
  Mission b = a;
  a.fleet_size = b.fleet_size = 2;
  b.robot = "b";
  b.start = b.goal = {20, 20};
  AgentRun before;
  for (const Mission& mission : {a, b}) before.hear(mission, 0);
  before.hear(map_message(), 0);
  before.run(0, 3, 1);
  std::vector<Message> kept = before.store.messages;
  if (!keeps_what_it_passed_on)
    std::erase_if(kept, [](const Message& message) {
      const auto* state = std::get_if<RobotState>(&message);
      return state != nullptr && state->passed_on;
    });
  AgentRun after;
  after.restore(kept);
  b.cancelled = b_is_cancelled;
  for (const Mission& mission : {a, b}) after.hear(mission, 5);
  after.hear(map_message(), 5);
  after.run(5, 200);
  return of<AgentStatus>(after.said).back();
}

TEST(AgentRestart, TheJournalHoldsPeersThatFellSilentBeforeTheRestart) {
  EXPECT_EQ(last_status_of_one_alone(true).phase, Phase::arrived);
}

TEST(AgentRestart, TheJournalForgetsTheSilenceOfAPeerThatIsHeardAgain) {
  AgentRun run;
  run_until_killed_at(0.5, run);
  RobotState b = run.standing_b(0.6);
  b.passed_on = true;
  run.keeper.said(b);
  ASSERT_EQ(saved_state_of(run.store.messages)->silent.size(), 1u);
  run.hear(run.standing_b(0.55), 0.7);  // it was overtaken on its way
  EXPECT_EQ(saved_state_of(run.store.messages)->silent.size(), 1u);
  run.hear(run.standing_b(0.8), 0.8);
  EXPECT_TRUE(saved_state_of(run.store.messages)->silent.empty());
  b.promise.stamp = 0.8;
  run.keeper.said(b);
  ASSERT_EQ(saved_state_of(run.store.messages)->silent.size(), 1u);
  EXPECT_EQ(saved_state_of(run.store.messages)->silent[0].state.promise.stamp, 0.8);
}

TEST(AgentRestart, AnAgentThatCannotKnowWhereAPeerFailedStandsAndSaysSo) {
  const AgentStatus status = last_status_of_one_alone(false);
  EXPECT_EQ(status.phase, Phase::gave_up);
  EXPECT_EQ(status.reason,
            "its agent was started or woke in mid-run, and nobody who is alive knows where all others are");
}

TEST(AgentRestart, ACancelledMissionDoesNotTellWhereAPeerFailed) {
  EXPECT_EQ(last_status_of_one_alone(false, true).phase, Phase::gave_up);
  EXPECT_EQ(last_status_of_one_alone(true, true).phase, Phase::arrived);
}

// The last peer that the agent meets may be the only one that knows where a robot failed.
TEST(AgentRestart, TheAgentCountsAsNewForAWhileAfterItMetTheLastPeer) {
  Mission mine = mission_of_a(0);
  mine.fleet_size = 2;
  Mission of_b = mine;
  of_b.robot = "b";
  of_b.start = of_b.goal = {20, 20};
  AgentRun before;
  for (const Message& message : {Message(map_message()), Message(mine), Message(of_b)})
    before.hear(message, 0);
  before.run(0, 3, 3);
  AgentRun after;
  after.restore(before.store.messages);
  for (const Message& message : {Message(map_message()), Message(mine), Message(of_b)})
    after.hear(message, 20);
  after.run(20, 25);
  after.run(25, 30, 30);
  double last = 0;
  for (const RobotState& state : of<RobotState>(after.said)) last = state.is_new ? state.promise.stamp : last;
  EXPECT_GT(last, 25.7);
  EXPECT_LT(last, 27);
}

}  // namespace
}  // namespace coppice
