// Agents and a broker that outlive the runs that they drive, as units of systemd do: what they said in one
// run is not taken for the next one's.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "files/report_file.h"
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
    command.insert(command.end(), {"--domain", "138"});
    processes.push_back(std::make_unique<test::Background>(command, log(name)));
    return *processes.back();
  }
  test::Background& start_run(const std::string& name, const std::string& scenario, int count = robots) {
    return start(
        name, {"planner_service", (test::scenarios() / scenario).string(), "--robots", std::to_string(count),
               "--time-scale", "10", "--report", file(name, ".json"), "--trajectory", file(name, ".csv")});
  }
  std::filesystem::path log(const std::string& name) const { return folder.path() / (name + ".log"); }
  std::string file(const std::string& name, const std::string& kind) const {
    return (folder.path() / (name + kind)).string();
  }

  /// That it is whole, and of this run alone.
  void expect_a_whole_run(const std::string& name, const std::string& scenario) {
    ASSERT_EQ(start_run(name, scenario).wait(), 0) << test::contents(log(name));
    const proto::Report report = read_report(file(name, ".json"));
    EXPECT_EQ(report.outcome(), "arrived");
    const auto tracks = test::read_trajectory_rows(file(name, ".csv"));
    for (const auto& robot : report.robots()) {
      SCOPED_TRACE(name + " " + robot.name());
      const auto& track = tracks.at(robot.name());
      ASSERT_GE(robot.path_size(), 2);
      const test::Place start{robot.path(0).x(), robot.path(0).y()};
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

TEST_F(NextRun, IsWholeAfterOneThatEndedAndAfterOneWhoseServiceWasKilled) {
  expect_a_whole_run("first", "blank-10.json");
  expect_a_whole_run("second", "rooms-8.json");
  test::Background& killed = start_run("killed", "blank-10.json");
  ASSERT_TRUE(test::within(
      20s, [&] { return test::contents(log("killed")).find("paths found 3/3") != std::string::npos; }));
  std::this_thread::sleep_for(1s);  // ten of fleet time
  killed.send(SIGKILL);
  killed.wait();
  expect_a_whole_run("last", "rooms-8.json");
}

// It has heard the others say that they stand, in a run that is over and before it hears of its own.
TEST_F(NextRun, OfFewerRobotsIsDrivenByAnAgentThatWasStartedAnewInBetween) {
  expect_a_whole_run("first", "blank-10.json");
  test::Background& first = *processes[1];
  first.send(SIGKILL);
  first.wait();
  const test::Background& anew = start("r1-anew", {"robot_agent", "--name", "r1"});
  std::this_thread::sleep_for(3s);
  EXPECT_EQ(start_run("second", "rooms-8.json", 1).wait(), 0) << test::contents(log("second"));
  EXPECT_FALSE(test::has_ended(anew.pid())) << test::contents(log("r1-anew"));
}

}  // namespace
}  // namespace coppice
