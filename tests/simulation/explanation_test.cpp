// Explanations of simulated runs agree with what the bodies did: who waited for whom, and when.
#include "monitor/recording/explanation.h"

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coppice/files/scenario_file.h"
#include "coppice/simulate/simulation_recording.h"
#include "tests/support.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

using Watch = std::function<bool(FleetSimulation&, double)>;

/// A run that is simulated, recorded and told.
struct Told {
  Told(
      Scenario what, SimulationSettings settings,
      const Watch& watch = [](FleetSimulation&, double) { return true; })
      : scenario(std::move(what)), simulation(scenario, std::move(settings)) {
    SimulationRecording recorder(simulation, {file});
    simulation.run([&](const PlannerService&, double now) { return watch(simulation, now); });
    recorder.finish();
    recording = std::make_unique<Recording>(file);
    stories = stories_of(*recording);
  }
  const Track& track(const RobotName& robot) const {
    return std::ranges::find(simulation.tracks(), robot, &NamedTrack::robot)->track;
  }
  double largest_speed(const RobotName& robot) const {
    return std::ranges::find(scenario.robots, robot, &RobotTask::name)->max_speed;
  }
  std::string all_of(const RobotName& robot) const {
    std::string text;
    for (const std::string& line : explain_run(stories, robot)) text += line + '\n';
    return text;
  }
  std::string moment_of(const RobotName& robot, double time) const {
    std::string text;
    for (const std::string& line : explain_moment(*recording, stories, robot, time)) text += line + '\n';
    return text;
  }

  test::TemporaryFolder folder{};
  std::string file = (folder.path() / "run.mcap").string();
  Scenario scenario;
  FleetSimulation simulation;
  std::unique_ptr<Recording> recording{};
  Stories stories{};
};

Scenario shipped(const char* name) {
  return read_scenario(test::scenarios() / name, {});
}

/// The last status of each robot, and for whom it waited, by the stamps of its states.
struct Said {
  std::map<RobotName, AgentStatus> status{};
  std::map<RobotName, std::map<double, RobotName>> waits_for{};
};
Said said_in(const Recording& recording) {
  Said said;
  Playback playback(recording, recording.begin());
  while (const auto next = playback.next()) {
    if (const auto* s = std::get_if<AgentStatus>(next->message.get())) said.status[s->robot] = *s;
    if (const auto* s = std::get_if<RobotState>(next->message.get()); s != nullptr && !s->passed_on)
      said.waits_for[s->robot][s->promise.stamp] = s->waits_for;
  }
  return said;
}

/// The robot hardly moves from soon after the beginning of the episode until soon before its end.
void expect_stands(const Told& told, const RobotName& robot, const Episode& e) {
  constexpr double soon = 0.5;  // seconds: it brakes, or sets off
  for (const TrackPoint& p : told.track(robot).points) {
    if (p.time < e.from + soon || p.time > e.until - soon) continue;
    EXPECT_LT(p.velocity.norm(), waiting_speed_share * told.largest_speed(robot))
        << sentence_of(robot, e) << " It moves at " << p.time;
  }
}

TEST(SimulatedExplanation, RobotsWaitAtGatesForThoseThatTheyNamed) {
  const Told told(shipped("door-20.json"), {.timeout = 300});
  const Said said = said_in(*told.recording);
  int gates = 0;
  for (const auto& [robot, story] : told.stories.robots) {
    double waited = 0;
    for (const Episode& e : story) {
      if (e.doing.act != Act::gate) continue;
      ++gates;
      waited += e.until - e.from;
      expect_stands(told, robot, e);
      const auto named = said.waits_for.at(robot).lower_bound(e.from - 1e-6)->second;
      EXPECT_EQ(e.doing.other, named);
      EXPECT_NE(sentence_of(robot, e).find("stood and waited for " + named + " to pass at "),
                std::string::npos)
          << sentence_of(robot, e);
      ASSERT_TRUE(e.gate) << sentence_of(robot, e);
      EXPECT_GT(e.gate->left, 0);
    }
    EXPECT_NEAR(waited, said.status.at(robot).waits.gate, 1 + 0.1 * waited) << told.all_of(robot);
  }
  EXPECT_GT(gates, 10);
}

TEST(SimulatedExplanation, EpisodesFollowEachOtherAndAgreeWithTheTrack) {
  const Told told(shipped("rooms-8.json"), {.timeout = 300});
  for (const auto& [robot, story] : told.stories.robots) {
    ASSERT_FALSE(story.empty()) << robot;
    for (std::size_t k = 1; k < story.size(); ++k) EXPECT_EQ(story[k].from, story[k - 1].until) << robot;
    for (const Episode& e : story) {
      const auto& points = told.track(robot).points;
      const auto p = std::ranges::lower_bound(points, e.from - 1e-6, {}, &TrackPoint::time);
      if (p == points.end() || p->time > e.from + 1e-6) continue;
      EXPECT_LT((p->position - e.begin).norm(), 1e-6) << sentence_of(robot, e);
    }
    const auto arrived = std::ranges::find(story, Act::arrived, [](const Episode& e) { return e.doing.act; });
    ASSERT_NE(arrived, story.end()) << told.all_of(robot);
  }
}

TEST(SimulatedExplanation, AKilledRobotIsNotHeardFromThenOn) {
  SimulationSettings settings{.timeout = 30};
  settings.faults.kills = {{"r3", 4}};
  const Told told(shipped("rooms-8.json"), std::move(settings));
  const Episode& last = told.stories.robots.at("r3").back();
  EXPECT_EQ(last.doing.act, Act::silent) << told.all_of("r3");
  EXPECT_NEAR(last.from, 4, 0.1);
  EXPECT_GT(last.until, 20);
  const std::string moment = told.moment_of("r1", 15);
  EXPECT_NE(moment.find("Failed: r3 was last heard at " + fmt::format("{:.2f}", last.from)),
            std::string::npos)
      << moment;
}

/// Two robots in an aisle in which they cannot pass each other. The one ahead is halted for some time.
TEST(SimulatedExplanation, ARobotStandsBehindOneThatAnOperatorHas) {
  Scenario aisle{.map_name = "aisle", .map = test::open_map(300, 12), .seed = 1, .robots = {}};
  aisle.robots = {{"behind", {20, 6}, {20, 6}, 5, 20, 40, 1}, {"ahead", {60, 6}, {60, 6}, 5, 20, 40, 1}};
  int phase = 0;
  const Told told(aisle, {.takes_orders = true}, [&](FleetSimulation& fleet, double now) {
    if (phase == 0 && now > 3) {
      fleet.give({.id = "far", .robots = {"ahead"}, .visits = {{{280, 6}}}});
      fleet.give({.id = "near", .robots = {"behind"}, .visits = {{{240, 6}}}});
      phase = 1;
    } else if (phase == 1 && now > 7) {
      fleet.give({.id = "halt", .action = Action::pause, .robots = {"ahead"}, .by = "Ann"});
      phase = 2;
    }
    return now < 40;
  });
  const std::string ahead = told.all_of("ahead");
  EXPECT_NE(ahead.find("got mission 2, to (280.0, 6.0) (order far)"), std::string::npos) << ahead;
  EXPECT_NE(ahead.find("ahead was halted (order halt of Ann): paused by the operator."), std::string::npos)
      << ahead;
  const Story& story = told.stories.robots.at("ahead");
  const auto halted = std::ranges::find(story, Act::halted, [](const Episode& e) { return e.doing.act; });
  ASSERT_NE(halted, story.end()) << ahead;
  EXPECT_NEAR(halted->from, 7, 0.5);
  const std::string behind = told.moment_of("behind", 11);
  EXPECT_NE(behind.find("ahead was halted"), std::string::npos) << behind << told.all_of("behind");
}

}  // namespace
}  // namespace coppice
