// Tests of a restarted planner service as a state machine, message by message.
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "planner_service/run/planner_service.h"
#include "planner_service/run/saved_run.h"
#include "tests/tracks.h"
#include "tests/unit/messages/kept.h"
#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

Scenario one_robot() {
  Scenario scenario{.map_name = "wall", .map = wall_with_door(), .robots = {}};
  scenario.robots = {{"a", {20, 60}, {100, 60}, 5, 20, 40, 1}};
  return scenario;
}

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
  Kept<RunKeeper> kept{};
};

constexpr WallTime begins = 4;  // the missions begin; until then the service waits for a broker

AgentStatus arrived(std::uint32_t mission, std::uint32_t points) {
  AgentStatus status{.robot = "a", .mission = mission, .phase = Phase::arrived};
  status.run = {begins};
  status.arrival_time = 5;
  status.path_time = 0.5;
  status.nodes_valid = 10;
  status.track_points = points;
  return status;
}

TEST(ServiceRestart, ARestartedServiceGoesOnWithMissionsAndTracks) {
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

  // The agent repeats its track: no point is counted twice.
  after.on(arrival_of(TrackMessage{"a", 2, 0, {{0, {20, 60}, {0, 0}}, {5, {100, 60}, {0, 0}}}, begins}, 11));
  EXPECT_EQ(test::all_points(after.tracks())[0].size(), 2u);
}

TEST(ServiceRestart, ARestartedServiceEndsARunThatHadEnded) {
  ServiceRun before;
  before.step(0);
  before.step(begins);
  before.hear(TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}, {5, {100, 60}, {0, 0}}}, begins}, 9);
  before.hear(arrived(1, 2), 9);
  EXPECT_TRUE(of<Mission>(before.step(9.1)).at(0).cancelled);
  PlannerService after(one_robot(), before.settings, 10);
  ASSERT_TRUE(after.recall(before.kept.store.messages, 10));
  EXPECT_TRUE(of<Mission>(after.step(10)).at(0).cancelled);
  after.step(23.6);
  EXPECT_FALSE(after.finished());  // its agent may only now find the service, and has the end of the track
  after.step(23.8);
  EXPECT_TRUE(after.finished());
  EXPECT_TRUE(after.everybody_arrived());
}

// The bus of the agents discovers a restarted service after some seconds.
TEST(ServiceRestart, ARestartedServiceWaitsForTheEndOfTheTracks) {
  ServiceRun before;
  before.step(0);
  before.step(begins);
  before.hear(TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}, {5, {99, 60}, {1, 0}}}, begins}, 9);
  before.hear(arrived(1, 2), 9);
  before.step(9.1);
  PlannerService after(one_robot(), before.settings, 10);
  ASSERT_TRUE(after.recall(before.kept.store.messages, 10));
  after.step(10);
  AgentStatus stopped = arrived(1, 3);
  stopped.phase = Phase::stopped;
  after.on(arrival_of(TrackMessage{"a", 1, 2, {{5.05, {99.5, 60}, {0, 0}}}, begins}, 18));
  after.on(arrival_of(stopped, 18));
  after.step(18);
  EXPECT_TRUE(after.finished());
  EXPECT_TRUE(after.everybody_arrived());
}

// The robot is stopped because its agent does not know where it was. The others go on, also under the next
// service.
TEST(ServiceRestart, AStoppedRobotEndsNoRun) {
  ServiceRun before(0, two_robots());
  before.step(0);
  before.step(begins);
  const auto tells = [](const char* robot, double time, const Point2& place) {
    return TrackMessage{robot, 1, 0, {{time, place, {0, 0}}}, begins};
  };
  before.hear(tells("a", 0.05, {20, 60}), 5);
  before.hear(tells("b", 0.05, {20, 20}), 5);
  before.hear(tells("a", 2, {20, 60}), 6);  // from its start again
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

/// A fleet that takes orders; a drives to and fro.
struct StandingService {
  StandingService() : service(two_robots(), settings, 0) { take_missions(map_and_missions(service)); }
  void drive(double until) {
    for (; now < until; now += 0.5) {
      for (const char* robot : {"a", "b"}) {
        TrackMessage batch{
            robot, missions.at(robot).number, points[robot], {}, missions.at(robot).clock.run()};
        for (int k = 0; k < 10; ++k) {
          const double time = now + 0.05 * k;
          const Point2 start = missions.at(robot).start;
          const double along = robot[0] == 'a' ? 5 * std::sin(time) : 0;
          batch.points.push_back(
              {time, start + Point2(along, 0), {robot[0] == 'a' ? 5 * std::cos(time) : 0, 0}});
        }
        points[robot] += 10;
        sent.push_back(batch);
        service.on(arrival_of(batch, now + 0.5));
        AgentStatus status{.robot = robot, .mission = batch.mission, .phase = Phase::driving};
        status.run = batch.run;
        status.track_points = points[robot];
        service.on(arrival_of(status, now + 0.5));
      }
      take_missions(service.step(now + 0.5));
    }
  }
  void take_missions(const std::vector<Message>& said) {
    for (const Mission& mission : of<Mission>(said)) missions[mission.robot] = mission;
  }
  static constexpr ServiceSettings settings{.waits_for_goals = true};
  double now = 0;
  PlannerService service;
  std::map<RobotName, Mission> missions;
  std::map<RobotName, std::uint32_t> points;
  std::vector<TrackMessage> sent;
};

// The service forgets tracks that it has counted.
TEST(ServiceRestart, TheReportOfAFleetThatServesCountsAllOfItsTracks) {
  StandingService run;
  run.drive(400);
  std::vector<NamedTrack> whole{{"a", {5, {}}}, {"b", {5, {}}}};
  for (const TrackMessage& batch : run.sent) {
    for (const TrackMessage::Point& p : batch.points)
      whole[batch.robot == "a" ? 0 : 1].track.points.push_back({p.time, p.position, p.velocity, 0, 0});
  }
  EXPECT_LT(test::all_points(run.service.tracks())[0].size(), 2000u) << "of 8,000";
  const proto::Report of_all = run.service.report(in_parts(whole));
  const proto::Report counted = run.service.report();
  for (int k = 0; k < 2; ++k)
    EXPECT_NEAR(counted.robots(k).driven_length(), of_all.robots(k).driven_length(), 1e-6);
  EXPECT_NEAR(counted.least_separation(), of_all.least_separation(), 1e-9);
  EXPECT_NEAR(counted.least_clearance(), of_all.least_clearance(), 1e-9);
  EXPECT_EQ(counted.robots(0).points_missing(), 0u);
}

TEST(ServiceRestart, ASnapshotSaysWhatAllMessagesSaid) {
  StandingService run;
  run.drive(200);
  run.service.on(arrival_of(OrderMessage{.id = "1", .robots = {"b"}, .visits = {{{100, 20}}}}, run.now));
  run.take_missions(run.service.step(run.now));
  run.drive(210);
  const PlannerService::Snapshot saved = run.service.snapshot();
  EXPECT_LT(of<TrackMessage>(saved.messages).size(), 20u);
  PlannerService after(two_robots(), StandingService::settings, run.now);
  ASSERT_TRUE(after.recall(saved.figures));
  ASSERT_TRUE(after.recall(saved.messages, run.now));
  EXPECT_EQ(after.report().SerializeAsString(), run.service.report().SerializeAsString());
  EXPECT_EQ(after.snapshot().figures.SerializeAsString(), saved.figures.SerializeAsString());
  EXPECT_EQ(after.snapshot().messages, saved.messages);
  // It goes on with what comes next, and does not count again what it has.
  for (const TrackMessage& batch : run.sent) after.on(arrival_of(batch, run.now));
  EXPECT_EQ(after.report().SerializeAsString(), run.service.report().SerializeAsString());
}

TEST(ServiceRestart, AGapInATrackIsCounted) {
  StandingService run;
  run.drive(10);
  run.points["a"] += 30;
  run.drive(20);
  EXPECT_EQ(run.service.report().robots(0).points_missing(), 30u);
  EXPECT_EQ(run.service.report().robots(1).points_missing(), 0u);
}

TEST(RunKeeper, TheRecordHoldsNothingOfAPreviousRun) {
  RunKeeper record;
  const auto track = [](WallTime run) { return TrackMessage{"a", 1, 0, {{0, {20, 60}, {0, 0}}}, run}; };
  AgentStatus status{.robot = "a", .mission = 1};
  status.run = {50};
  EXPECT_EQ(record.heard(track(50)), Keep::nothing);
  Mission mission{.robot = "a", .map_id = {}, .clock = {100, 1}};
  EXPECT_EQ(record.said(mission), Keep::append);
  EXPECT_EQ(record.heard(track(50)), Keep::nothing);
  EXPECT_EQ(record.heard(status), Keep::nothing);
  EXPECT_EQ(record.heard(PathMessage{"a", 1, {}, 50}), Keep::nothing);
  EXPECT_EQ(record.heard(track(100)), Keep::append);
}

TEST(ServiceRestart, TheStateOfAnotherRunIsRefused) {
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

}  // namespace
}  // namespace coppice
