// Roles whose process was killed, and those who take their place: as state machines, message by message.
#include <gtest/gtest.h>

#include "planner_service/planner_service.h"
#include "planner_service/run_record.h"
#include "planning/map_generator.h"
#include "robot_agent/robot_agent.h"
#include "tests/tracks.h"
#include "tests/unit/roles.h"
#include "tree_broker/forest_record.h"
#include "tree_broker/tree_broker.h"

namespace coppice {
namespace {

Scenario one_robot() {
  Scenario scenario{.map_name = "wall", .map = wall_with_door(), .robots = {}};
  scenario.robots = {{"a", {20, 60}, {100, 60}, 5, 20, 40, 1}};
  return scenario;
}

/// What a process keeps, and would find again.
template <class Chooser>
struct Kept {
  explicit Kept(Chooser chooser = Chooser()) : keeper(std::move(chooser), &store) {}
  Kept(const Kept&) = delete;
  KeptInMemory store;
  Keeper<Chooser, KeptInMemory> keeper;
};

// --- brokers ---

MapMessage map_message() {
  return {"wall", wall_with_door(), {5}};
}

MapMessage rooms() {
  Random random(1);
  return {"rooms", generate_map(MapKind::room, 400, 400, random), {5}};
}

/// Brokers that hear each other at once, stepped each millisecond.
struct Brokers {
  void run(double seconds) {
    for (const double until = now + seconds; now < until; now += 0.001) {
      for (std::size_t i = 0; i < brokers.size(); ++i) {
        if (!brokers[i] || brokers[i]->next_wake() > now) continue;
        for (const Message& message : brokers[i]->step(now)) hear(message, i);
      }
    }
  }
  void hear(const Message& message, std::size_t from) {
    said[from].push_back(message);
    for (std::size_t i = 0; i < brokers.size(); ++i) {
      if (i != from && brokers[i]) brokers[i]->on(arrival_of(message, now));
    }
  }
  std::set<TreeId> trees_of(std::size_t i) const {
    std::set<TreeId> ids;
    for (const auto& tree : of<InactiveTreeMessage>(said[i])) ids.insert(tree.tree);
    return ids;
  }
  double now = 100;
  std::vector<std::optional<TreeBroker>> brokers{};
  std::vector<std::vector<Message>> said = std::vector<std::vector<Message>>(3);
};

TEST(Brokers, TheSecondStandsByAndTakesOverWithinTwoSecondsWithAllTrees) {
  Brokers fleet;
  fleet.brokers.emplace_back(TreeBroker(9, 1));
  fleet.brokers[0]->on(arrival_of(rooms(), fleet.now));
  fleet.run(0.1);
  fleet.brokers.emplace_back(TreeBroker(4, 2));
  fleet.brokers[1]->on(arrival_of(rooms(), fleet.now));
  for (const Message& message : fleet.said[0]) fleet.brokers[1]->on(arrival_of(message, fleet.now));
  fleet.run(1);
  EXPECT_TRUE(fleet.brokers[0]->leads());
  EXPECT_FALSE(fleet.brokers[1]->leads());
  const std::set<TreeId> trees = fleet.trees_of(0);
  ASSERT_FALSE(trees.empty());
  EXPECT_TRUE(fleet.trees_of(1).empty());

  fleet.brokers[0].reset();
  fleet.run(2);
  ASSERT_TRUE(fleet.brokers[1]->leads());
  EXPECT_EQ(fleet.trees_of(1), trees);  // they cover the map: no more are needed
  // It went on where the other was: most of the map was covered.
  EXPECT_LT(2 * of<BrokerStatus>(fleet.said[1]).back().nodes_valid,
            of<BrokerStatus>(fleet.said[0]).back().nodes_valid);
  EXPECT_EQ(of<BrokerStatus>(fleet.said[1]).back().trees_published, fleet.trees_of(1).size());
  EXPECT_EQ(of<BrokerStatus>(fleet.said[1]).back().covered_map, "rooms");
}

TEST(Brokers, OfTwoThatLeadTheOneThatDidSoFirstGoesOn) {
  Brokers fleet;
  for (const std::uint64_t id : {9u, 4u}) {
    fleet.brokers.emplace_back(TreeBroker(id, id));
    fleet.brokers.back()->on(arrival_of(map_message(), fleet.now));
    fleet.brokers.back()->step(fleet.now);  // neither hears of the other yet
    fleet.now += 0.01;
    EXPECT_TRUE(fleet.brokers.back()->leads());
  }
  fleet.run(1);
  EXPECT_TRUE(fleet.brokers[0]->leads());
  EXPECT_FALSE(fleet.brokers[1]->leads());
}

TEST(Brokers, OneThatIsStartedAnewPublishesWhatItKept) {
  Kept<ForestRecord> kept;
  Brokers fleet;
  fleet.brokers.emplace_back(TreeBroker(9, 1));
  fleet.brokers[0]->on(arrival_of(map_message(), fleet.now));
  kept.keeper.heard(map_message());
  fleet.run(1);
  for (const Message& message : fleet.said[0]) kept.keeper.said(message);
  for (const Message& message : fleet.said[0]) kept.keeper.heard(message);  // again, from another broker
  EXPECT_EQ(of<InactiveTreeMessage>(kept.store.messages).size(), fleet.trees_of(0).size());

  fleet.brokers[0].reset();
  fleet.brokers.emplace_back(TreeBroker(10, 3));
  fleet.brokers[1]->recall(kept.store.messages, fleet.now);
  fleet.run(0.9);
  EXPECT_FALSE(fleet.brokers[1]->leads());  // another one may
  fleet.run(0.2);
  EXPECT_TRUE(fleet.brokers[1]->leads());
  EXPECT_EQ(fleet.trees_of(1), fleet.trees_of(0));  // they cover the map: no more are needed

  // Another map: what was kept of this one is of no use.
  kept.keeper.heard(MapMessage{"other", wall_with_door(), {5}});
  EXPECT_EQ(kept.store.messages.size(), 1u);
}

TEST(Brokers, ATreeThatOnlyOneThatCameBackKnowsIsPublished) {
  Brokers fleet;
  fleet.brokers.emplace_back(TreeBroker(9, 1));
  fleet.brokers[0]->on(arrival_of(rooms(), fleet.now));
  fleet.run(2);
  const std::set<TreeId> trees = fleet.trees_of(0);
  InactiveTreeMessage unheard = of<InactiveTreeMessage>(fleet.said[0]).front();
  unheard.tree = {77, 0};
  fleet.brokers.emplace_back(TreeBroker(10, 3));
  fleet.brokers[1]->recall(std::vector<Message>{rooms(), unheard}, fleet.now);
  for (const Message& message : fleet.said[0]) fleet.brokers[1]->on(arrival_of(message, fleet.now));
  fleet.run(4);
  EXPECT_TRUE(fleet.brokers[0]->leads());
  EXPECT_EQ(fleet.trees_of(1), std::set{unheard.tree});
  EXPECT_TRUE(fleet.trees_of(0).contains(unheard.tree));
  EXPECT_EQ(fleet.trees_of(0).size(), trees.size() + 1);
}

// --- the service ---

struct ServiceRun {
  explicit ServiceRun(double lifelong = 0, const Scenario& scenario = one_robot())
      : settings{.lifelong = lifelong}, service(scenario, settings, 0) {}
  std::vector<Message> step(double now) {
    auto all = service.step(now);
    for (const Message& message : all) kept.keeper.said(message);
    return all;
  }
  void hear(const Message& message, double now) {
    kept.keeper.heard(message);
    service.on(arrival_of(message, now));
  }
  ServiceSettings settings;
  PlannerService service;
  Kept<RunRecord> kept{};
};

constexpr WallTime begins = 4;  // of the missions: until then it waits for a broker

AgentStatus arrived(std::uint32_t mission, std::uint32_t points) {
  AgentStatus status{.robot = "a", .mission = mission, .phase = Phase::arrived};
  status.run = begins;
  status.arrival_time = 5;
  status.path_time = 0.5;
  status.nodes_valid = 10;
  status.track_points = points;
  return status;
}

TEST(PlannerServiceAnew, GoesOnWithTheMissionsAndTheRecord) {
  ServiceRun before(20);
  before.step(0);
  const auto first = of<Mission>(before.step(begins));  // no broker came
  ASSERT_EQ(first.size(), 1u);
  before.hear(PathMessage{"a", 1, {{20, 60}, {60, 15}, {100, 60}}, begins}, 5);
  before.hear(TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}, {5, {100, 60}, {0, 0}}}, begins}, 9);
  before.hear(arrived(1, 2), 9);
  const auto second = of<Mission>(before.step(9.1));
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(second[0].number, 2u);

  PlannerService after(one_robot(), before.settings, 10);
  ASSERT_TRUE(after.recall(before.kept.store.messages, 10));
  const auto again = of<Mission>(after.step(10));
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0], second[0]);
  EXPECT_TRUE(of<Mission>(after.step(10.2)).empty());
  EXPECT_EQ(test::all_points(after.tracks())[0].size(), 2u);
  EXPECT_EQ(after.progress(10).missions, 1);
  EXPECT_EQ(after.report().nodes_valid(), before.service.report().nodes_valid());

  // The agent says its track again: nothing is counted twice.
  after.on(arrival_of(TrackMessage{"a", 2, 0, {{0, {20, 60}, {0, 0}}, {5, {100, 60}, {0, 0}}}, begins}, 11));
  EXPECT_EQ(test::all_points(after.tracks())[0].size(), 2u);
}

TEST(PlannerServiceAnew, EndsARunThatHadEnded) {
  ServiceRun before;
  before.step(0);
  before.step(begins);
  before.hear(TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}, {5, {100, 60}, {0, 0}}}, begins}, 9);
  before.hear(arrived(1, 2), 9);
  EXPECT_TRUE(of<Mission>(before.step(9.1)).at(0).cancelled);
  PlannerService after(one_robot(), before.settings, 10);
  ASSERT_TRUE(after.recall(before.kept.store.messages, 10));
  EXPECT_TRUE(of<Mission>(after.step(10)).at(0).cancelled);
  after.step(13.1);
  EXPECT_TRUE(after.finished());
  EXPECT_TRUE(after.everybody_arrived());
}

// It is stopped, for it does not know where it was; the others go on, also under the next service.
TEST(PlannerServiceAnew, OneRobotThatWasStoppedEndsNoRun) {
  ServiceRun before(0, two_robots());
  before.step(0);
  before.step(begins);
  const auto tells = [](const char* robot, double time, const Point2& place) {
    return TrackMessage{robot, 1, 0, {{time, place, {0, 0}}}, begins};
  };
  before.hear(tells("a", 0.05, {20, 60}), 5);
  before.hear(tells("b", 0.05, {20, 20}), 5);
  before.hear(tells("a", 2, {20, 60}), 6);  // from its start once more
  const auto stopped = of<Mission>(before.step(6));
  ASSERT_EQ(stopped.size(), 2u);
  EXPECT_TRUE(stopped[0].cancelled);
  EXPECT_FALSE(stopped[1].cancelled);

  PlannerService after(two_robots(), before.settings, 7);
  ASSERT_TRUE(after.recall(before.kept.store.messages, 7));
  const auto again = of<Mission>(after.step(7));
  ASSERT_EQ(again.size(), 2u);
  EXPECT_TRUE(again[0].cancelled);
  EXPECT_FALSE(again[1].cancelled);
  EXPECT_FALSE(after.finished());
}

TEST(RunRecord, KeepsNothingOfARunBefore) {
  RunRecord record;
  const auto track = [](WallTime run) { return TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}}, run}; };
  AgentStatus status{.robot = "a", .mission = 1};
  status.run = 50;
  EXPECT_EQ(record.heard(track(50)), Keep::nothing);
  Mission mission{.robot = "a", .map_id = {}, .clock = {100, 1}};
  EXPECT_EQ(record.said(mission), Keep::append);
  EXPECT_EQ(record.heard(track(50)), Keep::nothing);
  EXPECT_EQ(record.heard(status), Keep::nothing);
  EXPECT_EQ(record.heard(PathMessage{"a", 1, {}, 50}), Keep::nothing);
  EXPECT_EQ(record.heard(track(100)), Keep::append);
}

TEST(PlannerServiceAnew, RefusesWhatIsOfAnotherRun) {
  ServiceRun before;
  before.step(0);
  before.step(4);
  Scenario other = one_robot();
  other.robots[0].goal = {100, 20};
  EXPECT_FALSE(PlannerService(other, {}, 5).recall(before.kept.store.messages, 5));
  other = one_robot();
  other.map.blocked[0] = 1;
  EXPECT_FALSE(PlannerService(other, {}, 5).recall(before.kept.store.messages, 5));
  other = one_robot();
  other.robots.push_back({"b", {20, 20}, {20, 40}, 5, 20, 40, 1});
  EXPECT_FALSE(PlannerService(other, {}, 5).recall(before.kept.store.messages, 5));
  EXPECT_FALSE(PlannerService(one_robot(), {.time_scale = 2}, 5).recall(before.kept.store.messages, 5));
  EXPECT_TRUE(PlannerService(one_robot(), {}, 5).recall(before.kept.store.messages, 5));
  EXPECT_TRUE(PlannerService(one_robot(), {}, 5).recall({}, 5));
}

// --- the agent ---

/// Alone, stepped whenever it wants.
struct AgentRun {
  AgentRun() = default;
  AgentRun(const AgentRun&) = delete;
  void recall(const std::vector<Message>& kept) {
    agent.recall(memory_of(kept));
    Remembrance remembrance("a");
    remembrance.recall(kept);
    store.messages = kept;
    keeper = Keeper(std::move(remembrance), &store);
  }
  void hear(const Message& message, double now) {
    keeper.heard(message);
    agent.on(arrival_of(message, now));
  }
  /// Another, that stands at its start, is heard until `b_dies`.
  void run(double from, double until, double b_dies = 0) {
    for (double now = from; now < until; now = std::max(now + 0.001, agent.next_wake())) {
      if (now < b_dies) hear(standing_b(now), now);
      for (Outgoing& one : agent.step(now)) {
        keeper.said(one.message);
        said.push_back(std::move(one.message));
      }
    }
  }
  RobotState standing_b(double now) const {
    RobotState state{.robot = "b",
                     .sequence = static_cast<std::uint32_t>(now / 0.05),
                     .stamp = now,
                     .position = {20, 20},
                     .radius = 5,
                     .max_speed = 20,
                     .max_acceleration = 40,
                     .promise = {now + 0.05, {0, 0}, now + 0.1},
                     .knot = {},
                     .echoes = {}};
    if (!said.empty()) state.echoes.push_back({"a", now, now});
    return state;
  }
  RobotAgent agent{"a"};
  KeptInMemory store{};
  Keeper<Remembrance, KeptInMemory> keeper{Remembrance("a"), &store};
  std::vector<Message> said{};
};

Mission mission_of_a(double epoch) {
  return {.robot = "a",
          .number = 1,
          .map_id = "wall",
          .start = {20, 60},
          .goal = {100, 60},
          .radius = 5,
          .max_speed = 20,
          .max_acceleration = 40,
          .goal_tolerance = 1,
          .plan_budget = 0.1,
          .clock = {epoch, 1}};
}

/// Of a robot that drives.
void run_until_killed_at(double time, AgentRun& before) {
  before.hear(map_message(), 0);
  before.hear(mission_of_a(0), 0);
  before.run(0, time);
}

std::vector<TrackMessage::Point> track_in(const std::vector<Message>& said) {
  std::vector<TrackMessage::Point> track;
  for (const TrackMessage& batch : of<TrackMessage>(said)) {
    EXPECT_EQ(batch.first_index, track.size());
    track.insert(track.end(), batch.points.begin(), batch.points.end());
  }
  return track;
}

TEST(RobotAgentAnew, GoesOnFromWhereItsBodyBrakedTo) {
  AgentRun before;
  run_until_killed_at(3, before);
  const RobotState last = of<RobotState>(before.said).back();
  ASSERT_GT(last.velocity.norm(), 5);  // it drives

  AgentRun after;
  after.recall(before.store.messages);
  after.hear(map_message(), 6);
  after.hear(mission_of_a(0), 6);
  after.run(6, 20);
  EXPECT_EQ(of<AgentStatus>(after.said).back().phase, Phase::arrived);
  const RobotState first = of<RobotState>(after.said).front();
  EXPECT_GT(first.sequence, last.sequence);
  EXPECT_TRUE(first.velocity.isZero(0));
  EXPECT_LT((first.position - last.position).norm(), 20 * 20 / (2 * 40) + 3);

  // The record goes from the start to the goal without a gap, as fast as a robot may.
  const std::vector<TrackMessage::Point> track = track_in(after.said);
  EXPECT_EQ(track.front().position, Point2(20, 60));
  EXPECT_LT((track.back().position - Point2(100, 60)).norm(), 1);
  for (std::size_t k = 1; k < track.size(); ++k) {
    ASSERT_NEAR(track[k].time - track[k - 1].time, 0.05, 1e-6);
    ASSERT_LT((track[k].position - track[k - 1].position - 0.05 * track[k - 1].velocity).norm(), 1e-9);
    ASSERT_LE((track[k].velocity - track[k - 1].velocity).norm(), 40 * 0.05 + 1e-9);
  }
  // What it had said before it was killed, it says again just so.
  const auto said_before = of<TrackMessage>(before.said);
  ASSERT_FALSE(said_before.empty());
  for (const TrackMessage& batch : said_before) {
    for (std::size_t k = 0; k < batch.points.size(); ++k)
      ASSERT_EQ(batch.points[k], track[batch.first_index + k]);
  }
  const AgentStatus status = of<AgentStatus>(after.said).back();
  EXPECT_EQ(status.path_time, of<AgentStatus>(before.said).back().path_time);
}

TEST(RobotAgentAnew, KilledAgainAndAgainItArrives) {
  auto life = std::make_unique<AgentRun>();
  run_until_killed_at(1.5, *life);
  double now = 2;
  for (int k = 0; k < 6; ++k) {
    auto next = std::make_unique<AgentRun>();
    next->recall(life->store.messages);
    next->hear(map_message(), now);
    next->hear(mission_of_a(0), now);
    next->run(now, now + 2.5);
    now += 2.6;
    life = std::move(next);
  }
  EXPECT_EQ(of<AgentStatus>(life->said).back().phase, Phase::arrived);
}

TEST(RobotAgentAnew, LeavesOutOfItsTrackTheSleepThatItsPredecessorLeftOut) {
  AgentRun first;
  run_until_killed_at(3, first);
  ASSERT_GT(of<RobotState>(first.said).back().velocity.norm(), 5);  // it brakes, and then it stands
  std::vector<Message> kept = first.store.messages;
  std::vector<TrackMessage::Point> before = track_in(first.said);
  for (const double woken : {700.0, 703.0}) {
    AgentRun next;
    next.recall(kept);
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

TEST(RobotAgentAnew, ItsTrackBeginsWithItsFirstState) {
  AgentRun before;
  before.hear(map_message(), 7.03);
  before.hear(mission_of_a(0), 7.03);
  before.run(7.13, 9);  // late
  AgentRun after;
  after.recall(before.store.messages);
  after.hear(map_message(), 10);
  after.hear(mission_of_a(0), 10);
  after.run(10, 11);
  EXPECT_EQ(track_in(before.said).front().time, of<RobotState>(before.said).front().stamp);
  EXPECT_EQ(track_in(after.said).front(), track_in(before.said).front());
}

/// Two robots are in the run: b dies at 1 s, a's agent is killed at 3 and started anew at 5 s.
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
  after.recall(kept);
  b.cancelled = b_is_cancelled;
  for (const Mission& mission : {a, b}) after.hear(mission, 5);
  after.hear(map_message(), 5);
  after.run(5, 200);
  return of<AgentStatus>(after.said).back();
}

TEST(RobotAgentAnew, WhoFellSilentBeforeIsInItsJournal) {
  EXPECT_EQ(last_status_of_one_alone(true).phase, Phase::arrived);
}

TEST(RobotAgentAnew, WhoWasHeardOfAgainIsNotInItsJournalAsSilent) {
  AgentRun run;
  run_until_killed_at(0.5, run);
  RobotState b = run.standing_b(0.6);
  b.passed_on = true;
  run.keeper.said(b);
  ASSERT_EQ(memory_of(run.store.messages)->silent.size(), 1u);
  run.hear(run.standing_b(0.55), 0.7);  // overtaken on its way
  EXPECT_EQ(memory_of(run.store.messages)->silent.size(), 1u);
  run.hear(run.standing_b(0.8), 0.8);
  EXPECT_TRUE(memory_of(run.store.messages)->silent.empty());
  b.stamp = 0.8;
  run.keeper.said(b);
  ASSERT_EQ(memory_of(run.store.messages)->silent.size(), 1u);
  EXPECT_EQ(memory_of(run.store.messages)->silent[0].state.stamp, 0.8);
}

TEST(RobotAgentAnew, OneThatCannotKnowWhereAnotherDiedStandsAndSaysSo) {
  const AgentStatus status = last_status_of_one_alone(false);
  EXPECT_EQ(status.phase, Phase::no_path);
  EXPECT_EQ(status.reason,
            "its agent was started in mid-run, and nobody who is alive knows where all others are");
}

TEST(RobotAgentAnew, ACancelledMissionDoesNotTellWhereAnotherDied) {
  EXPECT_EQ(last_status_of_one_alone(false, true).phase, Phase::no_path);
  EXPECT_EQ(last_status_of_one_alone(true, true).phase, Phase::arrived);
}

TEST(RobotAgentAnew, WhatItKeptOfAnotherRunIsNoUse) {
  AgentRun before;
  run_until_killed_at(3, before);
  AgentRun after;
  after.recall(before.store.messages);
  after.hear(map_message(), 106);
  after.hear(mission_of_a(106), 106);
  after.run(106, 107);
  EXPECT_EQ(of<RobotState>(after.said).front().position, Point2(20, 60));
}

// The service's clock was set back, or it is another host's.
TEST(RobotAgentAnew, KeepsARunThatIsEarlierThanItsJournals) {
  AgentRun before;
  before.hear(map_message(), 1000);
  before.hear(mission_of_a(1000), 1000);
  before.run(1000, 1003);
  AgentRun after;
  after.recall(before.store.messages);
  after.hear(map_message(), 106);
  after.hear(mission_of_a(106), 106);
  after.run(106, 109);
  const RobotState last = of<RobotState>(after.said).back();
  EXPECT_GT(last.position.x(), 25);
  const std::optional<Memory> memory = memory_of(after.store.messages);
  ASSERT_TRUE(memory.has_value());
  EXPECT_EQ(memory->mission.clock.epoch, 106);
  EXPECT_EQ(memory->track.front().position, Point2(20, 60));
  EXPECT_EQ(memory->body.position(), last.position);
}

TEST(RobotAgentAnew, KeepsNoRunThatItPassesOver) {
  Remembrance remembrance("a");
  Mission of_another = mission_of_a(100);
  of_another.robot = "b";
  EXPECT_EQ(remembrance.heard(of_another), Keep::nothing);
  EXPECT_EQ(remembrance.heard(mission_of_a(50)), Keep::nothing);
  EXPECT_EQ(remembrance.heard(mission_of_a(100)), Keep::begin_anew);
  EXPECT_EQ(remembrance.heard(mission_of_a(50)), Keep::nothing);
  EXPECT_EQ(remembrance.heard(mission_of_a(100)), Keep::nothing);
}

TEST(RobotAgentAnew, OneThatGoesOnLivingServesTheNextRunToo) {
  AgentRun agent;
  run_until_killed_at(20, agent);  // it has arrived
  agent.hear(mission_of_a(100), 100);
  agent.said.clear();
  agent.run(100, 120);
  EXPECT_EQ(of<RobotState>(agent.said).front().position, Point2(20, 60));
  EXPECT_EQ(of<AgentStatus>(agent.said).back().phase, Phase::arrived);
  EXPECT_EQ(of<TrackMessage>(agent.said).front().first_index, 0u);
  const std::optional<Memory> memory = memory_of(agent.store.messages);
  ASSERT_TRUE(memory.has_value());
  EXPECT_EQ(memory->track.front().position, Point2(20, 60));
  EXPECT_EQ(memory->mission.clock.epoch, 100);
}

}  // namespace
}  // namespace coppice
