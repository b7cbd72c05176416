// Tests of fleets under delay, loss and failures: nothing touches, and every robot arrives that can.
#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coppice/files/scenario_file.h"
#include "coppice/files/scenario_generator.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/support.h"

namespace coppice {
namespace {

struct Outcome {
  proto::Report report;
  std::vector<std::string> broken;
};

/// Seconds. The random faults depend on it, too.
constexpr double usual_timeout = 1000;

Outcome simulate(const Scenario& scenario, const Faults& faults, double timeout = usual_timeout) {
  FleetSimulation simulation(scenario, {.timeout = timeout, .faults = faults});
  simulation.run([](const PlannerService&, double) { return true; });
  const std::vector<NamedTrack>& tracks = simulation.tracks();
  return {simulation.service().report(in_parts(tracks)), broken_invariants(scenario, simulation)};
}

Outcome simulate(const std::string& name, int robots, std::uint32_t seed, const Faults& faults) {
  return simulate(make_scenario(name, robots, seed), faults);
}

void expect_all_arrive(const Outcome& outcome, const std::string& what) {
  EXPECT_EQ(outcome.report.outcome(), "arrived") << what;
  EXPECT_TRUE(outcome.broken.empty()) << what << ": " << outcome.broken.front();
}

TEST(Faults, LossAndDelayCostOnlyTime) {
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    for (const char* name : {"circle", "door-14", "corridor-24"}) {
      const Faults faults{
          .bus = {.loss = 0.3, .delay = 0.2, .jitter = 0.1, .duplicate = 0.05, .reorder = true}};
      expect_all_arrive(simulate(name, 10, seed, faults), name);
    }
  }
}

// Robots that wait for their turn to reserve stand side by side with those that set off.
TEST(Faults, LossAndDelayAtMostDoubleTheTimeThatTheRobotsTake) {
  const auto sum_of_run_times = [](const Outcome& outcome) {
    double sum = 0;
    for (const auto& robot : outcome.report.robots()) sum += robot.run_time();
    return sum;
  };
  for (const char* name : {"corridor-40", "rooms"}) {
    const Outcome undisturbed = simulate(name, 20, 1, {});
    const Outcome outcome = simulate(name, 20, 1, {.bus = {.loss = 0.3, .delay = 0.2, .jitter = 0.1}});
    expect_all_arrive(outcome, name);
    EXPECT_LT(sum_of_run_times(outcome), 2 * sum_of_run_times(undisturbed)) << name;
  }
}

TEST(Faults, PausesCostOnlyTime) {
  for (std::uint32_t seed = 1; seed <= 2; ++seed)
    expect_all_arrive(simulate("circle", 10, seed, {.pause_rate = 300}), "circle");
}

TEST(Faults, NothingTouchesARobotWhoseAgentIsKilled) {
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    const Outcome outcome = simulate("rooms", 20, seed, {.kills = {{"r3", 4}}});
    EXPECT_TRUE(outcome.broken.empty()) << seed << ": " << outcome.broken.front();
    int arrived = 0;
    for (const auto& robot : outcome.report.robots()) {
      arrived += robot.arrived();
      EXPECT_EQ(robot.arrived(), robot.reason().empty()) << robot.name();
    }
    EXPECT_GE(arrived, 15) << seed;
  }
}

// Two robots have to pass in a corridor. A failed one covers the goal of one of them, but not all positions
// that count as arrived.
TEST(Faults, AGoalPartlyCoveredByAFailedRobotIsReachedBesideIt) {
  Scenario scenario = make_scenario("pocket-14", 2, 1);
  const double y = scenario.robots[0].start.y();
  scenario.robots[0].start.x() = 60;
  scenario.robots[1].goal.x() = 40;
  RobotTask failed = scenario.robots[0];
  failed.name = "dead";
  failed.start = {30.2, y};
  failed.goal = {16, y};
  scenario.robots.push_back(failed);
  const Outcome outcome = simulate(scenario, {.kills = {{"dead", 0.1}}});
  EXPECT_TRUE(outcome.broken.empty()) << outcome.broken.front();
  EXPECT_TRUE(outcome.report.robots(0).arrived()) << outcome.report.robots(0).reason();
  EXPECT_TRUE(outcome.report.robots(1).arrived()) << outcome.report.robots(1).reason();
  EXPECT_FALSE(outcome.report.robots(2).arrived());
}

// A robot fails on its way while the process of another has yet to start. The late one must not assume that
// the failed one stands where its mission began.
TEST(Faults, ALateRobotLearnsWhereAPeerFailed) {
  const OccupancyMap open{.width = 512, .height = 256, .blocked = std::vector<std::uint8_t>(512 * 256, 0)};
  Scenario scenario{.map_name = "open", .map = open, .robots = {}};
  scenario.robots = {{"a", {180, 130}, {215, 125}, 5, 20, 40, 1},
                     {"b", {170, 100}, {450, 100}, 5, 20, 40, 1},
                     {"c", {200, 60}, {320, 142.5}, 5, 20, 40, 1}};
  const Outcome outcome = simulate(scenario, {.kills = {{"c", 0.01}, {"b", 14}}, .restart_after = 20});
  expect_all_arrive(outcome, "one late, one dead for a while");
}

// Found by trying seeds: some peers lost the last states of the killed robot, and assumed that it stood short
// of its position.
TEST(Faults, AllKnowWhereAFailedRobotStandsDespiteLostLastStates) {
  for (const std::uint32_t seed : {2u, 3u}) {
    const Faults faults{.bus = {.loss = 0.3, .delay = 0.2, .jitter = 0.1}, .kills = {{"r2", 3}}};
    const Outcome outcome = simulate("rooms", 20, seed, faults);
    EXPECT_TRUE(outcome.broken.empty()) << seed << ": " << outcome.broken.front();
  }
}

// Of two robots, only one hears the other: a state lost on that link is lost to all.
TEST(Faults, AFailedRobotIsKeptClearIfItsLastStatesReachedNobody) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const Faults faults{.bus = {.loss = 0.3, .delay = 0.2, .jitter = 0.1},
                        .kills = {{seed % 2 == 0 ? "r1" : "r2", 2 + 0.25 * seed}}};
    const Outcome outcome = simulate("pocket-18", 2, seed, faults);
    EXPECT_TRUE(outcome.broken.empty()) << seed << ": " << outcome.broken.front();
  }
}

TEST(Faults, APartitionedFleetStandsUntilThePartitionHeals) {
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    const Faults faults{.bus = {.partitions = {{5, 25}}}};
    for (const char* name : {"circle", "rooms", "corridor-24"})
      expect_all_arrive(simulate(name, 10, seed, faults), name);
  }
}

// In a small fleet, one robot may be cut off alone. Of two robots, each declares the other failed.
TEST(Faults, PartsOfAnySizeStandUntilThePartitionHeals) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    expect_all_arrive(simulate("loop-14", 2, seed, {.bus = {.partitions = {{3, 20}}}}), "loop-14");
    const Faults lossy{.bus = {.loss = 0.3, .delay = 0.2, .jitter = 0.1, .partitions = {{4, 50}}}};
    for (const int robots : {2, 3, 5}) {
      expect_all_arrive(simulate("circle", robots, seed, {.bus = {.partitions = {{2, 15}}}}), "circle");
      expect_all_arrive(simulate("circle", robots, seed, lossy), "circle");
    }
    expect_all_arrive(simulate("corridor-24", 10, seed, {.bus = {.partitions = {{4, 60}}}}), "corridor-24");
  }
}

/// Two robots that meet head-on, and a distant group of other robots.
Scenario two_and_a_far_crowd(int crowd, int away) {
  const int width = 1000;
  const int height = away + 100 + 20 * crowd;
  Scenario scenario{
      .map_name = "wide",
      .map = {.width = width,
              .height = height,
              .blocked = std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), 0)},
      .seed = 1,
      .robots = {}};
  const auto add = [&](std::string name, const Point2& from, const Point2& to) {
    scenario.robots.push_back({std::move(name), from, to, 5, 20, 40, 1});
  };
  add("east", {100, 50}, {900, 50});
  add("west", {900, 50}, {100, 50});
  add("friend", {930, 70}, {930, 90});
  for (int k = 0; k < crowd; ++k)
    add(fmt::format("r{}", k), {500, 50 + away + 20 * k}, {530, 50 + away + 20 * k});
  return scenario;
}

// The distant robots send to them rarely. Still, what they heard of one robot must reach the other.
TEST(Faults, NoRobotTouchesAPeerThatOnlyOthersDiscover) {
  for (const int away : {50, 400}) {
    for (const int crowd : {2, 30, 120}) {
      const Faults faults{.bus = {.loss = 0.35, .cut_links = {{"east", "west", 0, 100}}}};
      expect_all_arrive(simulate(two_and_a_far_crowd(crowd, away), faults),
                        fmt::format("{} others, {} m away", crowd, away));
    }
  }
}

TEST(Faults, TwoRobotsThatNeverDiscoverEachOtherGiveUpAndSayWhy) {
  const Outcome outcome =
      simulate(two_and_a_far_crowd(8, 400), {.bus = {.cut_links = {{"east", "west", 0, 500}}}});
  EXPECT_TRUE(outcome.broken.empty()) << outcome.broken.front();
  EXPECT_EQ(outcome.report.outcome(), "incomplete");
  const auto says = [&](int k, const std::string& of) {
    return outcome.report.robots(k).reason().find("hears nothing of " + of) != std::string::npos;
  };
  EXPECT_TRUE(says(0, "west")) << outcome.report.robots(0).reason();
  EXPECT_TRUE(says(1, "east")) << outcome.report.robots(1).reason();
}

// The absent robots are missed as well, and asked for.
TEST(Faults, NoRobotTouchesAnUndiscoveredPeerIfManyRobotsNeverCame) {
  for (const int away : {50, 400}) {
    for (const int never_came : {1, 3, 20}) {
      Scenario scenario = two_and_a_far_crowd(30, away);
      scenario.robots[0].start = {480, 50};
      scenario.robots[1].start = {520, 50};
      Faults faults{.bus = {.cut_links = {{"east", "west", 0, 100}}}};
      for (int k = 0; k < never_came; ++k) faults.kills.push_back({fmt::format("r{}", k), 0});
      const Outcome outcome = simulate(scenario, faults);
      const std::string what = fmt::format("{} never came, {} m away", never_came, away);
      EXPECT_TRUE(outcome.broken.empty()) << what << ": " << outcome.broken.front();
      for (const int k : {0, 1}) {
        EXPECT_TRUE(outcome.report.robots(k).arrived()) << what;
        EXPECT_GT(outcome.report.robots(k).run_time(), 100) << what;
      }
    }
  }
}

// A robot that evaded its peers' possible positions would drive where no peer expects it.
TEST(Faults, ARobotThatMissesAllPeersStandsWhereItBraked) {
  for (int k = 0; k < 20; ++k) {
    const double end = 4 + 0.1 * k;
    const Scenario scenario = read_scenario(test::scenarios() / "blank-10.json", {.robots = 4});
    const Faults faults{.kills = {{"r1", end}, {"r3", end}, {"r4", end}}};
    FleetSimulation simulation(scenario, {.timeout = 60, .faults = faults});
    simulation.run([](const PlannerService&, double) { return true; });
    const auto& points = simulation.tracks().at(1).track.points;
    const auto at = [&](double time) {
      return std::ranges::lower_bound(points, time, std::less{}, &TrackPoint::time);
    };
    for (auto p = at(end + 4); p != at(end + 50); ++p)
      ASSERT_EQ(p->position, at(end + 4)->position) << end << " at " << p->time;
  }
}

TEST(Faults, WrongClocksCauseNoContact) {
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    expect_all_arrive(simulate("rooms", 8, seed, {.clock_skew = 1}), "rooms");
    const Faults faults{.bus = {.loss = 0.3, .delay = 0.2, .jitter = 0.1}, .clock_skew = 0.3};
    expect_all_arrive(simulate("corridor-24", 10, seed, faults), "corridor-24");
  }
}

// The simulation goes on moving the bodies. If a restarted agent assumes a wrong position, the track jumps.
TEST(Faults, KilledAndRestartedAgentsCostOnlyTime) {
  for (const double after : {0.3, 1.0, 4.0}) {
    const Faults faults{.kill_rate = 200, .restart_after = after};
    for (const char* name : {"rooms", "corridor-24", "door-14"})
      expect_all_arrive(simulate(name, 10, 1, faults), name);
    const Faults more{
        .bus = {.loss = 0.3, .delay = 0.2, .jitter = 0.1}, .kill_rate = 100, .restart_after = after};
    expect_all_arrive(simulate("rooms", 10, 2, more), "rooms");
  }
}

// Found by trying seeds: a restarted agent assumed that its peers stood where their missions begin, and moved
// out of their way into peers that had driven there.
TEST(Faults, ARestartedAgentStandsUntilItKnowsWhereItsPeersAre) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Faults faults{.kill_rate = 60, .restart_after = 0.3};
    expect_all_arrive(simulate("dead-end", 6, seed, faults), "dead-end");
  }
}

// No peer relays the last states of the failed robot any more when the other one returns.
TEST(Faults, ARestartedAgentKeepsClearOfRobotsThatFailedBefore) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const Faults faults{.bus = {.loss = seed % 2 == 0 ? 0.2 : 0.0},
                        .kills = {{"r3", 3, true}, {"r4", 8}},
                        .restart_after = 3};
    const Outcome outcome = simulate("rooms", 20, seed, faults);
    EXPECT_TRUE(outcome.broken.empty()) << seed << ": " << outcome.broken.front();
    EXPECT_TRUE(outcome.report.robots(3).arrived()) << seed << ": " << outcome.report.robots(3).reason();
  }
}

/// Robot a drives along a corridor of 1,700 m, 12 m wide. Robot b comes out of a side corridor at 1,500 m.
Scenario crossing_of_corridors(const RobotTask& a, const RobotTask& b, std::uint32_t seed) {
  OccupancyMap map{.width = 1700, .height = 160, .blocked = {}};
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      const bool is_free = row >= 14 && (row < 26 || (column >= 1494 && column < 1506));
      map.blocked.push_back(is_free ? 0 : 1);
    }
  }
  return {.map_name = "corridors", .map = std::move(map), .seed = seed, .robots = {a, b}};
}

// The peer takes the sleeper for failed, and drives. When the sleeper wakes, it must not take what it knew of
// the peer before for where the peer is.
TEST(Faults, ARobotThatSleptForLongStandsUntilItHearsItsPeer) {
  const Scenario scenario = crossing_of_corridors({"a", {1020, 20}, {1690, 20}, 5, 20, 40, 1},
                                                  {"b", {1500, 150}, {1500, 20}, 5, 4, 40, 1}, 9);
  const Faults faults{.bus = {.partitions = {{91, 140}}}, .pause_rate = 15, .pause = 70};
  expect_all_arrive(simulate(scenario, faults, 300), "one slept");
}

// A peer that counted on the restarted robot as failed brakes for ten seconds.
TEST(Faults, ARestartedRobotStandsUntilItsPeersMustHaveBraked) {
  const Scenario scenario = crossing_of_corridors({"a", {50, 20}, {1690, 20}, 5, 20, 2, 1},
                                                  {"b", {1500, 31.6}, {1500, 20}, 5, 2, 2, 1}, 1);
  for (const double after : {81.4, 82.4, 83.4}) {
    const Outcome outcome = simulate(scenario, {.kills = {{"b", 0.01}}, .restart_after = after});
    EXPECT_TRUE(outcome.broken.empty()) << after << ": " << outcome.broken.front();
  }
}

TEST(Faults, TheSameSeedGivesTheSameRun) {
  const Faults faults{.bus = {.loss = 0.2, .delay = 0.1, .jitter = 0.05}, .kill_rate = 20, .pause_rate = 100};
  const Outcome first = simulate("circle", 10, 5, faults);
  const Outcome second = simulate("circle", 10, 5, faults);
  EXPECT_EQ(first.report.SerializeAsString(), second.report.SerializeAsString());
}

}  // namespace
}  // namespace coppice
