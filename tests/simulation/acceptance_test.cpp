// Tests of every kind of scenario over many seeds, with and without faults. All robots arrive unless a failed
// robot closes their way, and nothing touches. The recorded tracks are judged by plain geometry alone
// (run_check.h).
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/files/map_file.h"
#include "coppice/files/scenario_generator.h"
#include "simulation/fleet_simulation.h"
#include "tests/run_check.h"
#include "tests/support.h"

namespace coppice {
namespace {

constexpr std::uint32_t seeds = 20;
constexpr double tolerance = 1e-3;  // metres
constexpr double goal_tolerance = 1;
/// Metres around a failed robot in which peers may believe it to stand that heard its last states late or not
/// at all.
constexpr double belief = 1;

struct Row {
  std::string name;
  int robots;
};

/// The name that GoogleTest prints.
void PrintTo(const Row& row, std::ostream* out) {
  *out << row.robots << ' ' << row.name;
}

test::Vertex place(const Point2& p) {
  return {p.x(), p.y()};
}

std::vector<test::Sample> samples_of(const Track& track) {
  std::vector<test::Sample> samples;
  for (const TrackPoint& point : track.points) samples.push_back({point.time, place(point.position)});
  return samples;
}

test::PlainMap plain(const OccupancyMap& map) {
  const test::TemporaryFolder folder;
  write_map(folder.path() / "plain.map", map);
  return test::PlainMap(folder.path() / "plain.map");
}

struct Body {
  test::Vertex end;
  double radius = 0;
};

/// Whether a robot could drive from where it stands to its goal past the failed ones, on a lattice of 0.5 m.
bool has_way(const test::PlainMap& map, const Scenario& scenario, const Body& robot, test::Vertex goal,
             const std::vector<Body>& failed) {
  constexpr double step = 0.5;
  const int width = static_cast<int>(scenario.map.width / step);
  const int height = static_cast<int>(scenario.map.height / step);
  const auto is_free = [&](test::Vertex p) {
    for (const Body& body : failed) {
      if (test::distance(p, body.end) < robot.radius + body.radius + belief) return false;
    }
    return map.clearance(p, p, robot.radius + 1) >= robot.radius;
  };
  std::vector<bool> seen(static_cast<std::size_t>(width * height));
  std::vector<int> open{static_cast<int>(robot.end.y / step) * width + static_cast<int>(robot.end.x / step)};
  while (!open.empty()) {
    const int cell = open.back();
    open.pop_back();
    const test::Vertex p{cell % width * step, cell / width * step};
    if (test::distance(p, goal) <= goal_tolerance && is_free(p)) return true;
    for (const auto& [i, j] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int x = cell % width + i;
      const int y = cell / width + j;
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      const auto next = static_cast<std::size_t>(y * width + x);
      if (seen[next] || !is_free({x * step, y * step})) continue;
      seen[next] = true;
      open.push_back(static_cast<int>(next));
    }
  }
  return false;
}

void expect_nothing_touches(const test::PlainMap& map, const std::vector<NamedTrack>& tracks,
                            const std::vector<std::vector<test::Sample>>& samples) {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const double radius = tracks[i].track.radius;
    for (std::size_t k = 1; k < samples[i].size(); ++k) {
      ASSERT_GE(map.clearance(samples[i][k - 1].place, samples[i][k].place, radius + 1), radius - tolerance)
          << tracks[i].robot << " at " << samples[i][k].time;
    }
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE(test::least_distance(samples[i], samples[j]), radius + tracks[j].track.radius - tolerance)
          << tracks[i].robot << " and " << tracks[j].robot;
    }
  }
}

/// The final positions decide which robots arrived. The report must agree and give a reason for each other
/// robot.
void expect_all_arrive_who_can(const test::PlainMap& map, const FleetSimulation& simulation,
                               const Scenario& scenario,
                               const std::vector<std::vector<test::Sample>>& samples) {
  const proto::Report report = simulation.service().report(in_parts(simulation.tracks()));
  std::vector<Body> failed;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    if (simulation.killed(scenario.robots[i].name))
      failed.push_back({samples[i].back().place, scenario.robots[i].radius});
  }
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const RobotTask& task = simulation.service().task(scenario.robots[i].name);
    const auto& said = report.robots(static_cast<int>(i));
    const Body body{samples[i].back().place, task.radius};
    const bool is_there = test::distance(body.end, place(task.goal)) <= goal_tolerance + tolerance;
    EXPECT_TRUE(!said.arrived() || is_there) << task.name << " is reported to have arrived";
    EXPECT_EQ(said.arrived(), said.reason().empty()) << task.name;
    if (said.arrived() || simulation.killed(task.name)) continue;
    EXPECT_FALSE(has_way(map, scenario, body, place(task.goal), failed))
        << task.name << ": " << said.reason();
  }
}

void run_and_judge(const Scenario& scenario, const SimulationSettings& settings) {
  FleetSimulation simulation(scenario, settings);
  simulation.run([](const PlannerService&, double) { return true; });
  const test::PlainMap map = plain(scenario.map);
  std::vector<std::vector<test::Sample>> samples;
  for (const NamedTrack& track : simulation.tracks()) samples.push_back(samples_of(track.track));
  expect_nothing_touches(map, simulation.tracks(), samples);
  expect_all_arrive_who_can(map, simulation, scenario, samples);
}

class Acceptance : public testing::TestWithParam<Row> {
 protected:
  void SetUp() override {
    if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  }

  void expect_from_all_seeds(const std::function<Faults(const Scenario&, Random&)>& faults_of) {
    for (std::uint32_t seed = first_seed; seed < first_seed + seeds; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      const Scenario scenario = make_scenario(GetParam().name, GetParam().robots, seed);
      Random random(seed);
      run_and_judge(scenario, {.timeout = 3000, .faults = faults_of(scenario, random)});
    }
  }

 private:
  static constexpr std::uint32_t first_seed = 1001;
};

Faults usual_faults() {
  return {.bus = {.loss = 0.3, .delay = 0.2, .jitter = 0.1}, .pause_rate = 60, .pause = 1};
}

TEST_P(Acceptance, AllRobotsArrive) {
  expect_from_all_seeds([](const Scenario&, Random&) { return Faults{}; });
}

TEST_P(Acceptance, AllRobotsArriveDespiteLossAndDelay) {
  expect_from_all_seeds([](const Scenario&, Random&) { return usual_faults(); });
}

TEST_P(Acceptance, AllRobotsArriveUnlessAFailedRobotClosesTheirWay) {
  expect_from_all_seeds([](const Scenario& scenario, Random& random) {
    Faults faults = usual_faults();
    const std::string& victim = scenario.robots[random.index(scenario.robots.size())].name;
    faults.kills = {{victim, random.uniform(2, 20)}};
    return faults;
  });
}

INSTANTIATE_TEST_SUITE_P(Scenarios, Acceptance,
                         testing::Values(Row{"circle", 10}, Row{"circle", 50}, Row{"circle", 100},
                                         Row{"circle", 250}, Row{"pocket-14", 2}, Row{"pocket-18", 2},
                                         Row{"loop-14", 2}, Row{"loop-18", 2}, Row{"corridor-24", 10},
                                         Row{"corridor-40", 20}, Row{"door-14", 10}, Row{"door-20", 20},
                                         Row{"crossing", 40}, Row{"rooms", 20}, Row{"rooms", 50},
                                         Row{"maze", 10}, Row{"maze", 20}, Row{"warehouse", 30},
                                         Row{"dead-end", 6}, Row{"mixed", 30}),
                         [](const auto& row) {
                           std::string name = row.param.name + "_" + std::to_string(row.param.robots);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

// Each robot gets a new goal on arrival, for half an hour.
TEST(LifelongAcceptance, GoalsAreGivenForHalfAnHour) {
  if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  for (const char* name : {"rooms", "maze"}) {
    for (std::uint32_t seed = 1001; seed < 1001 + seeds; ++seed) {
      SCOPED_TRACE(std::string(name) + " seed " + std::to_string(seed));
      run_and_judge(make_scenario(name, 20, seed), {.timeout = 5400, .lifelong = 1800});
    }
  }
}

}  // namespace
}  // namespace coppice
