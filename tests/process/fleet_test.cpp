// Tests of the real fleet: `coppice run` as a user types it, with its processes and its files, and its end in
// every way.
//
// CTest: PARALLEL

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/files/scenario_file.h"
#include "files/report_file.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/run_expectations.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using test::expect_good_motion;
using test::expect_good_paths;
using test::tolerance;

/// A run in its own folder.
struct FleetRun {
  explicit FleetRun(const std::filesystem::path& scenario, const std::vector<std::string>& options = {},
                    const std::string& time_scale = "10")
      : before(test::shared_memory()), process(command(scenario, options, time_scale), file("log")) {}

  std::filesystem::path file(const std::string& name) const { return folder.path() / name; }
  std::vector<std::string> command(const std::filesystem::path& scenario,
                                   const std::vector<std::string>& options,
                                   const std::string& time_scale) const {
    std::vector<std::string> all{test::program("coppice"),
                                 "run",
                                 scenario.string(),
                                 "--time-scale",
                                 time_scale,
                                 "--report",
                                 file("report.json").string(),
                                 "--trajectory",
                                 file("t.csv").string(),
                                 "--picture",
                                 file("p.svg").string()};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }
  std::string log() const { return test::contents(file("log")); }
  proto::Report report() const { return read_report(file("report.json")); }

  /// Whether the text appears on the terminal.
  bool says(const std::string& text) const {
    return test::within(10s, [&] { return log().find(text) != std::string::npos; });
  }
  bool has_begun() const { return says("paths found"); }
  std::size_t roles(const std::string& name) const {
    const auto children = test::children_of(process.pid());
    return static_cast<std::size_t>(std::count_if(children.begin(), children.end(),
                                                  [&](const auto& child) { return child.name == name; }));
  }
  /// The number of journals of its processes, in its own folders. Black boxes are none.
  std::size_t journals() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      const bool is_box = entry.path().parent_path().filename() == "black-boxes";
      count += entry.path().extension() == ".journal" && !is_box ? 1 : 0;
    }
    return count;
  }
  pid_t first(const std::string& name) const {
    for (const auto& child : test::children_of(process.pid())) {
      if (child.name == name) return child.pid;
    }
    return 0;
  }

  test::TemporaryFolder folder;
  std::set<std::string> before;
  test::Background process;
};

/// Checks that no process of the fleet lives, and that none of its files is left in shared memory.
void expect_nothing_left(const FleetRun& run, const std::vector<test::ProcessInfo>& children) {
  for (const auto& child : children) {
    EXPECT_TRUE(test::within(5s, [&] { return test::has_ended(child.pid); })) << child.name;
  }
  EXPECT_EQ(test::shared_memory(), run.before);
}

class FleetDiscovery : public testing::TestWithParam<const char*> {};

TEST_P(FleetDiscovery, AFleetInRoomsArrives) {
  const std::filesystem::path file = test::scenarios() / "rooms-8.json";
  const Scenario scenario = read_scenario(file, {});
  FleetRun run(file, {"--discovery", GetParam()});
  ASSERT_TRUE(run.has_begun()) << run.log();
  EXPECT_EQ(run.roles("tree_broker"), 1u);
  EXPECT_EQ(run.roles("planner_service"), 1u);
  EXPECT_EQ(run.roles("robot_agent"), scenario.robots.size());
  const auto children = test::children_of(run.process.pid());
  EXPECT_EQ(run.process.wait(), 0) << run.log();
  expect_nothing_left(run, children);

  const proto::Report report = run.report();
  EXPECT_EQ(report.outcome(), "arrived");
  std::vector<test::Expected> robots;
  for (const RobotTask& task : scenario.robots) {
    robots.push_back({task.name, {task.start.x(), task.start.y()}, {task.goal.x(), task.goal.y()}});
  }
  const test::PlainMap map(test::scenarios() / "rooms-8.map");
  expect_good_paths(report, robots, scenario.robots[0].radius, map);
  expect_good_motion(report, run.file("t.csv"), scenario.robots[0].radius, map);
  const auto tracks = test::read_trajectory_rows(run.file("t.csv"));
  for (const test::Expected& robot : robots) {
    EXPECT_LE(test::distance(tracks.at(robot.name).front().place, robot.start), 0.5) << robot.name;
    EXPECT_LE(test::distance(tracks.at(robot.name).back().place, robot.goal), 1 + tolerance) << robot.name;
  }
  EXPECT_NE(run.log().find("paths found 8/8, arrived 8/8"), std::string::npos) << run.log();
  EXPECT_NE(run.log().find("r8"), std::string::npos) << "the report's table";
  const std::string picture = test::contents(run.file("p.svg"));
  for (const test::Expected& robot : robots)
    EXPECT_NE(picture.find(">" + robot.name + "<"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Fleet, FleetDiscovery, testing::Values("multicast", "static"));

/// Runs the scenario with credentials that are made for it.
void expect_arrives_with_security(const std::string& name, const std::string& time_scale) {
  const test::TemporaryFolder keys;
  const test::Outcome made =
      test::shell("'" COPPICE_SOURCE_DIR "/deploy/security/make-keys' '" + keys.path().string() + "'");
  ASSERT_EQ(made.exit_code, 0) << made.output;
  const std::filesystem::path file = test::scenarios() / (name + ".json");
  FleetRun run(file, {"--security", keys.path().string()}, time_scale);
  EXPECT_EQ(run.process.wait(), 0) << run.log();
  const proto::Report report = run.report();
  EXPECT_EQ(report.outcome(), "arrived");
  expect_good_motion(report, run.file("t.csv"), read_scenario(file, {}).robots[0].radius,
                     test::PlainMap(test::scenarios() / (name + ".map")));
}

// Agents that knew the first server must not take the second one for the same and ignore its messages.
TEST(Fleet, ARestartedAgentFindsItsPeersThroughARestartedServer) {
  const test::TemporaryFolder folder;
  const std::vector<std::string> server{test::program("coppice"), "discovery", "--port", "23941"};
  const auto stands = [](const std::filesystem::path& log) {
    return test::within(20s,
                        [&] { return test::contents(log).find("discovery server 0") != std::string::npos; });
  };
  test::Background first(server, folder.path() / "first.log");
  ASSERT_TRUE(stands(folder.path() / "first.log"));
  FleetRun run(test::scenarios() / "rooms-8.json",
               {"--discovery", "127.0.0.1:23941", "--restart", "--timeout", "45"}, "1");
  ASSERT_TRUE(run.says("paths found 8/8")) << run.log();
  first.send(SIGKILL);
  first.wait();
  const test::Background second(server, folder.path() / "second.log");
  ASSERT_TRUE(stands(folder.path() / "second.log"));
  const pid_t agent = run.first("robot_agent");
  ASSERT_GT(agent, 0) << run.log();
  kill(agent, SIGKILL);
  EXPECT_EQ(run.process.wait(), 0) << run.log();
  EXPECT_EQ(run.report().outcome(), "arrived");
}

TEST(Fleet, AFleetOf8ArrivesWithSecurity) {
  expect_arrives_with_security("rooms-8", "5");
}
TEST(Fleet, AFleetOf20ArrivesWithSecurity) {
  if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  expect_arrives_with_security("rooms-20", "2");
}

/// Runs a reference map: paths are found, trees are shared, and all robots arrive without contact.
void expect_reference_map_planned(const std::string& name, const std::string& map_name) {
  const std::filesystem::path maps = std::filesystem::path(COPPICE_SHARED_DIR) / "maps";
  if (!std::filesystem::exists(maps)) GTEST_SKIP() << maps << " is not there";
  FleetRun run(maps / (name + ".scen"), {"--radius", "3", "--max-speed", "20"});
  EXPECT_EQ(run.process.wait(), 0) << run.log();
  const proto::Report report = run.report();
  const test::PlainMap map(maps / (map_name + ".map"));
  expect_good_paths(report, test::robots_of_scen(maps / (name + ".scen")), 3, map);
  expect_good_motion(report, run.file("t.csv"), 3, map);
  EXPECT_GT(report.trees_published(), 0u);
  EXPECT_GT(report.trees_grafted(), 0u);
  unsigned grafted = 0;
  for (const auto& robot : report.robots()) grafted += robot.grafted_trees();
  EXPECT_EQ(report.trees_grafted(), grafted);
}

TEST(Fleet, TheReferenceMapRoomIsPlanned) {
  expect_reference_map_planned("room1-10", "room1");
}
TEST(Fleet, TheReferenceMapMazeIsPlanned) {
  expect_reference_map_planned("maze1-5", "maze1");
}

/// The processes are started by hand on one domain. Each starts when the earlier ones have had time to find
/// no peer.
TEST(Fleet, ProcessesStartedByHandInAnyOrderFindEachOther) {
  const std::string scenario = (test::scenarios() / "blank-10.json").string();
  for (const bool service_first : {true, false}) {
    const test::TemporaryFolder folder;
    const std::string domain = test::domain_name(service_first ? 0 : 1);
    const std::string report = (folder.path() / "report.json").string();
    std::vector<std::unique_ptr<test::Background>> roles;
    const auto start = [&](std::vector<std::string> command) {
      command.insert(command.begin() + 1, {"--domain", domain});
      command[0] = test::program(command[0]);
      roles.push_back(std::make_unique<test::Background>(
          command, folder.path() / ("log" + std::to_string(roles.size()))));
      std::this_thread::sleep_for(300ms);
    };
    const auto start_service = [&] {
      start({"planner_service", scenario, "--robots", "2", "--time-scale", "10", "--report", report});
      return roles.size() - 1;
    };
    std::size_t service = 0;
    if (service_first) service = start_service();
    start({"robot_agent", "--name", "r2"});
    if (service_first) start({"tree_broker"});
    start({"robot_agent", "--name", "r1"});
    if (!service_first) start({"tree_broker"});
    if (!service_first) service = start_service();
    EXPECT_EQ(roles[service]->wait(), 0) << test::contents(folder.path() / ("log" + std::to_string(service)));
    EXPECT_EQ(read_report(report).outcome(), "arrived");
    for (std::size_t k = 0; k < roles.size(); ++k) {
      if (k == service) continue;
      roles[k]->send(SIGTERM);  // agents and brokers go on until they are stopped
      EXPECT_EQ(roles[k]->wait(), 0) << k;
    }
  }
}

TEST(Fleet, CtrlCEndsWithAReportAndLeavesNothing) {
  FleetRun run(test::scenarios() / "rooms-8.json");
  ASSERT_TRUE(run.has_begun()) << run.log();
  EXPECT_EQ(run.journals(), 0u) << "no process will be restarted";
  const auto children = test::children_of(run.process.pid());
  run.process.send(SIGINT);
  EXPECT_EQ(run.process.wait(), 1) << run.log();
  EXPECT_EQ(run.report().outcome(), "interrupted");
  expect_nothing_left(run, children);
}

TEST(Fleet, CtrlCWhileTheServiceAwaitsItsRestartEndsWithAReport) {
  FleetRun run(test::scenarios() / "rooms-8.json", {"--restart"}, "2");
  ASSERT_TRUE(run.has_begun()) << run.log();
  EXPECT_EQ(run.journals(), 10u);
  kill(run.first("planner_service"), SIGKILL);
  ASSERT_TRUE(run.says("planner_service ended early")) << run.log();
  run.process.send(SIGINT);
  EXPECT_EQ(run.process.wait(), 1) << run.log();
  EXPECT_EQ(run.report().outcome(), "interrupted");
}

TEST(Fleet, AKilledRunLeavesNothing) {
  FleetRun run(test::scenarios() / "rooms-8.json");
  ASSERT_TRUE(run.has_begun()) << run.log();
  const auto children = test::children_of(run.process.pid());
  EXPECT_GE(children.size(), 10u);
  run.process.send(SIGKILL);
  EXPECT_EQ(run.process.wait(), 128 + SIGKILL);
  expect_nothing_left(run, children);
}

TEST(Fleet, AKilledServiceEndsTheRunAndIsReported) {
  FleetRun run(test::scenarios() / "rooms-8.json");
  ASSERT_TRUE(run.has_begun()) << run.log();
  const auto children = test::children_of(run.process.pid());
  kill(run.first("planner_service"), SIGKILL);
  EXPECT_EQ(run.process.wait(), 1);
  EXPECT_NE(run.log().find("planner_service ended early"), std::string::npos) << run.log();
  expect_nothing_left(run, children);
}

TEST(Fleet, AKilledAgentIsReportedAndTheOthersGoOn) {
  // For one minute of wall time the agent may only be cut off: 600 s of this fleet's time.
  FleetRun run(test::scenarios() / "blank-10.json", {"--timeout", "1500"});
  ASSERT_TRUE(run.says("paths found 10/10")) << run.log();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // it drives, if the machine is not too busy
  kill(run.first("robot_agent"), SIGKILL);
  EXPECT_EQ(run.process.wait(), 1) << run.log();
  EXPECT_NE(run.log().find("r1 ended early, exit code 137"), std::string::npos) << run.log();
  const proto::Report report = run.report();
  EXPECT_FALSE(report.robots(0).arrived());
  EXPECT_FALSE(report.robots(0).reason().empty());
  EXPECT_EQ(report.collisions(), 0u) << run.log() << test::contents(run.file("report.json"));
  const auto track = test::read_trajectory_rows(run.file("t.csv")).at("r1");
  ASSERT_GE(track.size(), 2u);
  const test::Sample& before = track[track.size() - 2];
  EXPECT_LT(std::hypot(track.back().place.x - before.place.x, track.back().place.y - before.place.y), 0.11)
      << "the record shows how it braked: by 40 m/s2, in periods of 0.05 s";
  int arrived = 0;
  for (const auto& robot : report.robots()) arrived += robot.arrived();
  EXPECT_EQ(arrived, 9) << run.log();
}

TEST(Fleet, AKilledRecorderEndsTheRunWithAnError) {
  const test::TemporaryFolder folder;
  FleetRun run(test::scenarios() / "blank-10.json",
               {"--robots", "2", "--record", (folder.path() / "run.mcap").string()});
  ASSERT_TRUE(run.has_begun()) << run.log();
  kill(run.first("coppice"), SIGKILL);
  EXPECT_EQ(run.process.wait(), 1) << run.log();
  EXPECT_NE(run.log().find("recorder ended early"), std::string::npos) << run.log();
  EXPECT_EQ(run.report().outcome(), "arrived");
}

TEST(Fleet, FilesThatCannotBeWrittenAreReportedAfterTheTable) {
  FleetRun run(test::scenarios() / "blank-10.json", {"--robots", "2"});
  ASSERT_TRUE(run.has_begun()) << run.log();
  for (const char* name : {"report.json", "p.svg"}) std::filesystem::create_directory(run.file(name));
  EXPECT_EQ(run.process.wait(), 2);
  const std::string log = run.log();
  const auto table = log.find("arrived: 2 of 2 robots have a path");
  ASSERT_NE(table, std::string::npos) << log;
  EXPECT_NE(log.find("report.json: cannot be written", table), std::string::npos) << log;
  EXPECT_NE(log.find("p.svg: cannot be written", table), std::string::npos) << log;
  EXPECT_EQ(test::read_trajectory_rows(run.file("t.csv")).size(), 2u);
}

TEST(Fleet, RobotsMayHaveTheNamesOfProcesses) {
  const test::TemporaryFolder folder;
  std::string text = test::contents(test::scenarios() / "blank-10.json");
  const auto rename = [&](const std::string& from, const std::string& to) {
    text.replace(text.find('"' + from + '"'), from.size() + 2, '"' + to + '"');
  };
  rename("r1", "planner_service");
  rename("r2", "tree_broker");
  rename("r3", "recorder");
  std::filesystem::copy_file(test::scenarios() / "blank-10.map", folder.path() / "blank-10.map");
  FleetRun run(folder.write("scenario.json", text), {"--robots", "3", "--restart"}, "5");
  ASSERT_TRUE(run.has_begun()) << run.log();
  kill(run.first("robot_agent"), SIGKILL);
  EXPECT_TRUE(run.says("robot-planner_service ended early")) << run.log();
  EXPECT_EQ(run.process.wait(), 0) << run.log();
  EXPECT_EQ(run.report().outcome(), "arrived");
}

TEST(Fleet, LogsOfTheProcessesAreKeptAsRequested) {
  for (const std::string level : {"info", "off"}) {
    const test::TemporaryFolder folder;
    const std::filesystem::path logs = folder.path() / "of" / "today";
    FleetRun run(test::scenarios() / "blank-10.json",
                 {"--robots", "2", "--logs", logs.string(), "--log-json", "--log-level", level});
    EXPECT_EQ(run.process.wait(), 0) << run.log();
    for (const std::string name : {"tree_broker", "robot-r1", "robot-r2"}) {
      ASSERT_TRUE(std::filesystem::exists(logs / (name + ".log"))) << name;
      const std::string log = test::contents(logs / (name + ".log"));
      EXPECT_EQ(log.starts_with(R"({"time":)"), level == "info") << name << ": " << log;
    }
  }
}

TEST(Fleet, WarningsOfAgentsAreOnTheTerminalAndInTheReport) {
  const test::TemporaryFolder folder;
  std::string rows;  // a wall from top to bottom
  for (int j = 0; j < 20; ++j) rows += std::string(20, '.') + "@@" + std::string(18, '.') + "\n";
  folder.write("wall.map", "type octile\nheight 20\nwidth 40\nmap\n" + rows);
  FleetRun run(folder.write("wall.json", R"({"map": "wall.map", "radius": 1, "robots": [
    {"name": "shut-in", "start": {"x": 5, "y": 10}, "goal": {"x": 35, "y": 10}}]})"),
               {});
  EXPECT_EQ(run.process.wait(), 1) << run.log();
  const std::string reason = run.report().robots(0).reason();
  EXPECT_NE(reason.find("cannot be reached"), std::string::npos) << reason;
  EXPECT_NE(run.log().find("shut-in: warning: " + reason + "\n"), std::string::npos) << run.log();
}

TEST(Fleet, EveryRobotFindsAPathWithoutABroker) {
  FleetRun run(test::scenarios() / "rooms-8.json", {"--timeout", "60"});
  ASSERT_TRUE(run.has_begun()) << run.log();
  kill(run.first("tree_broker"), SIGKILL);
  EXPECT_LE(run.process.wait(), 1) << run.log();
  EXPECT_NE(run.log().find("tree_broker ended early"), std::string::npos) << run.log();
  const proto::Report report = run.report();
  for (const auto& robot : report.robots()) EXPECT_TRUE(robot.planned()) << robot.name();
  EXPECT_EQ(report.collisions(), 0u);
}

TEST(Fleet, AFleetWithoutReservationsArrives) {
  FleetRun run(test::scenarios() / "rooms-8.json", {"--coordination", "rvo"}, "4");
  EXPECT_EQ(run.process.wait(), 0) << run.log();
  const proto::Report report = run.report();
  EXPECT_EQ(report.outcome(), "arrived");
  EXPECT_EQ(report.collisions(), 0u);
  expect_good_motion(report, run.file("t.csv"), 5, test::PlainMap(test::scenarios() / "rooms-8.map"));
}

TEST(Fleet, TwoSimultaneousRunsDoNotMeet) {
  FleetRun first(test::scenarios() / "blank-10.json", {"--robots", "2"});
  FleetRun second(test::scenarios() / "blank-10.json", {"--robots", "3"});
  EXPECT_EQ(first.process.wait(), 0) << first.log();
  EXPECT_EQ(second.process.wait(), 0) << second.log();
  EXPECT_EQ(first.report().robots_size(), 2);
  EXPECT_EQ(second.report().robots_size(), 3);
}

TEST(CoppiceBench, TheBenchmarkLeavesNothingIfAFleetFails) {
  const test::TemporaryFolder folder;
  const test::Outcome outcome =
      test::shell("TMPDIR='" + folder.path().string() + "' '" + test::program("coppice") +
                  "' bench scale --quick --robots 2 --security /none --output /tmp");
  EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << outcome.output;
}

TEST(CoppiceBench, TheBenchmarkMeasuresHowAFleetOfProcessesGrows) {
  const test::TemporaryFolder folder;
  const std::string json = (folder.path() / "scale.json").string();
  const test::Outcome outcome =
      test::shell(test::program("coppice") + " bench scale --quick --robots 3 --output " +
                  folder.path().string() + " --report " + json);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string report = test::contents(json);
  EXPECT_NE(report.find("\"robots\": 3,"), std::string::npos) << report;
  EXPECT_NE(report.find("\"paths\": 3,"), std::string::npos) << report;
  EXPECT_NE(report.find("\"collisions\": 0}"), std::string::npos) << report;
  for (const char* measured : {"matched s", "states/agent/fleet s", "samples/agent/fleet s", "kB/s agent",
                               "CPU % agent", "MB agent", "MB broker", "MB service", "age p50 ms"}) {
    const auto at = report.find("\"" + std::string(measured) + "\": ");
    ASSERT_NE(at, std::string::npos) << measured;
    EXPECT_GT(std::atof(report.c_str() + at + std::string(measured).size() + 4), 0) << measured << report;
  }
}

}  // namespace
}  // namespace coppice
