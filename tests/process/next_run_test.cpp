// Tests of agents and a broker that outlive runs, as systemd units do. Their messages of one run must not be
// taken for those of the next.
//
// CTest: RESOURCE_LOCK lane_1

#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "files/report_file.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/run_check.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

constexpr int robots = 3;

struct NextRun : testing::Test {
  NextRun() {
    start("broker", {"tree_broker"});
    for (int k = 1; k <= robots; ++k)
      start("r" + std::to_string(k), {"robot_agent", "--name", "r" + std::to_string(k)});
  }
  test::Background& start(const std::string& name, std::vector<std::string> command) {
    command[0] = test::program(command[0]);
    command.insert(command.end(), {"--domain", test::domain_name()});
    processes.push_back(std::make_unique<test::Background>(command, log(name)));
    return *processes.back();
  }
  test::Background& start_run(const std::string& name, const std::string& scenario, int count = robots,
                              const char* scale = "10") {
    return start(
        name, {"planner_service", (test::scenarios() / scenario).string(), "--robots", std::to_string(count),
               "--time-scale", scale, "--report", file(name, ".json"), "--trajectory", file(name, ".csv")});
  }
  bool logs(const std::string& name, const std::string& text) const {
    return test::contents(log(name)).find(text) != std::string::npos;
  }
  std::filesystem::path log(const std::string& name) const { return folder.path() / (name + ".log"); }
  std::string file(const std::string& name, const std::string& kind) const {
    return (folder.path() / (name + kind)).string();
  }

  /// Checks that a run is complete and holds nothing of another run.
  void expect_a_whole_run(const std::string& name, const std::string& scenario) {
    ASSERT_EQ(start_run(name, scenario).wait(), 0) << test::contents(log(name));
    const proto::Report report = read_report(file(name, ".json"));
    EXPECT_EQ(report.outcome(), "arrived");
    const auto tracks = test::read_trajectory_rows(file(name, ".csv"));
    for (const auto& robot : report.robots()) {
      SCOPED_TRACE(name + " " + robot.name());
      const auto& track = tracks.at(robot.name());
      ASSERT_GE(robot.path_size(), 2);
      const test::Vertex start{robot.path(0).x(), robot.path(0).y()};
      EXPECT_LT(test::distance(track.front().place, start), 0.01);
      EXPECT_LT(track.front().time, 5);
      EXPECT_GT(robot.run_time(), 5);
      EXPECT_GE(track.back().time, robot.run_time() - 0.1);
      for (std::size_t k = 1; k < track.size(); ++k) EXPECT_GT(track[k].time, track[k - 1].time);
    }
  }

  test::TemporaryFolder folder;
  std::vector<std::unique_ptr<test::Background>> processes{};
};

TEST_F(NextRun, ARunIsCompleteAfterAnEndedRunAndAfterAKilledService) {
  expect_a_whole_run("first", "blank-10.json");
  expect_a_whole_run("second", "rooms-8.json");
  test::Background& killed = start_run("killed", "blank-10.json");
  ASSERT_TRUE(test::within(
      20s, [&] { return test::contents(log("killed")).find("paths found 3/3") != std::string::npos; }));
  std::this_thread::sleep_for(1s);  // 10 s of fleet time
  killed.send(SIGKILL);
  killed.wait();
  expect_a_whole_run("last", "rooms-8.json");
}

// The agent has heard its peers stand in a run that is over before it hears of its own run.
TEST_F(NextRun, ARestartedAgentDrivesTheNextRunWithFewerRobots) {
  expect_a_whole_run("first", "blank-10.json");
  test::Background& first = *processes[1];
  first.send(SIGKILL);
  first.wait();
  const test::Background& anew = start("r1-anew", {"robot_agent", "--name", "r1"});
  std::this_thread::sleep_for(3s);
  EXPECT_EQ(start_run("second", "rooms-8.json", 1).wait(), 0) << test::contents(log("second"));
  EXPECT_FALSE(test::has_ended(anew.pid())) << test::contents(log("r1-anew"));
}

// Two services would stop each other's robots.
TEST_F(NextRun, ASecondServiceNamesTheFirstAndRefuses) {
  test::Background& first = start_run("first", "rooms-8.json", robots, "2");
  ASSERT_TRUE(test::within(30s, [&] { return logs("first", "paths found 3/3"); }));
  test::Background& second = start_run("second", "blank-10.json");
  EXPECT_EQ(second.wait(), 2);
  EXPECT_TRUE(logs("second", "another planner service has the fleet on domain " + test::domain_name() +
                                 ": process " + std::to_string(first.pid()) + " on host "))
      << test::contents(log("second"));
  EXPECT_FALSE(std::filesystem::exists(file("second", ".json")));
  EXPECT_EQ(first.wait(), 0) << test::contents(log("first"));
  EXPECT_TRUE(logs("first", "another planner service is on this domain, and is to end: process " +
                                std::to_string(second.pid()) + " on host "))
      << test::contents(log("first"));
}

TEST_F(NextRun, OneOfTwoSimultaneousServicesDrives) {
  test::Background& one = start_run("one", "blank-10.json");
  test::Background& other = start_run("other", "blank-10.json");
  const std::set<int> codes{one.wait(), other.wait()};
  EXPECT_EQ(codes, (std::set<int>{0, 2})) << test::contents(log("one")) << test::contents(log("other"));
}

// Agents follow the newer run.
TEST_F(NextRun, AServiceThatWasPausedAndReplacedGivesUp) {
  test::Background& paused = start_run("paused", "rooms-8.json");
  ASSERT_TRUE(test::within(30s, [&] { return logs("paused", "paths found 3/3"); }));
  paused.send(SIGSTOP);
  test::Background& next = start_run("next", "rooms-8.json", robots, "2");
  ASSERT_TRUE(test::within(30s, [&] { return logs("next", "paths found 3/3"); }));
  paused.send(SIGCONT);
  EXPECT_EQ(paused.wait(), 2) << test::contents(log("paused"));
  EXPECT_TRUE(logs("paused", "another planner service has the fleet"));
  EXPECT_EQ(next.wait(), 0) << test::contents(log("next"));
}

TEST_F(NextRun, AgentAndServiceReportAnAgentWithoutAMission) {
  start("r9", {"robot_agent", "--name", "r9"});
  test::Background& run = start_run("run", "rooms-8.json");
  EXPECT_TRUE(test::within(30s, [&] {
    return logs("r9", "no mission for r9: the run has 3 robots, r1 to r3");
  })) << test::contents(log("r9"));
  EXPECT_TRUE(test::within(30s, [&] { return logs("run", "no mission for r9: the run has r1, r2, r3"); }))
      << test::contents(log("run"));
  EXPECT_EQ(run.wait(), 0);
  EXPECT_TRUE(logs("r1", "mission 1: from"));
  EXPECT_TRUE(logs("r1", "arrived at ")) << test::contents(log("r1"));
}

}  // namespace
}  // namespace coppice
