// TERM ends each program with exit code 0, and safely: a robot brakes first, and what it drove is on record.

#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "files/report_file.h"
#include "tests/processes.h"
#include "tests/run_check.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

struct Program {
  Program(const test::TemporaryFolder& folder, std::vector<std::string> command)
      : log(folder.path() / (command[0] + ".log")), process(started(std::move(command)), log) {}
  static std::vector<std::string> started(std::vector<std::string> command) {
    command[0] = test::program(command[0]);
    return command;
  }
  bool says(const std::string& text) const {
    return test::within(20s, [&] { return test::contents(log).find(text) != std::string::npos; });
  }
  int ends_by(int signal) {
    process.send(signal);
    EXPECT_TRUE(test::within(6s, [&] { return test::has_ended(process.pid()); })) << test::contents(log);
    return process.wait();
  }
  std::filesystem::path log;
  test::Background process;
};

TEST(Signals, ARobotThatIsToldToStopWhileItDrivesBrakesAndItsTrackIsComplete) {
  const test::TemporaryFolder folder;
  const std::string report = (folder.path() / "report.json").string();
  const std::string trajectory = (folder.path() / "t.csv").string();
  Program agent(folder, {"robot_agent", "--name", "r1", "--domain", "133"});
  Program service(folder, {"planner_service", (test::scenarios() / "blank-10.json").string(), "--robots", "1",
                           "--domain", "133", "--report", report, "--trajectory", trajectory});
  ASSERT_TRUE(service.says("paths found 1/1")) << test::contents(service.log);
  std::this_thread::sleep_for(2s);
  EXPECT_EQ(agent.ends_by(SIGTERM), 0) << test::contents(agent.log);
  EXPECT_EQ(service.process.wait(), 1) << test::contents(service.log);
  const proto::Report result = read_report(report);
  EXPECT_EQ(result.robots(0).reason(), "the agent was told to stop");
  const auto track = test::read_trajectory_rows(trajectory).at("r1");
  ASSERT_GT(track.size(), 40u);
  EXPECT_GT(test::distance(track.front().place, track.back().place), 5);
  EXPECT_LT(test::distance(track[track.size() - 2].place, track.back().place), 1e-9)
      << "it stands at the end";
}

TEST(Signals, TermEndsEveryOtherProgramToo) {
  const test::TemporaryFolder folder;
  Program broker(folder, {"tree_broker", "--domain", "134"});
  Program discovery(folder, {"coppice", "discovery", "--port", "23934"});
  Program agent(folder, {"robot_agent", "--name", "r1", "--domain", "134"});
  Program service(folder,
                  {"planner_service", (test::scenarios() / "blank-10.json").string(), "--domain", "135"});
  ASSERT_TRUE(broker.says("on domain 134"));
  ASSERT_TRUE(discovery.says("discovery server 0"));
  ASSERT_TRUE(agent.says("on domain 134"));
  ASSERT_TRUE(service.says("paths found"));
  EXPECT_EQ(broker.ends_by(SIGTERM), 0);
  EXPECT_EQ(discovery.ends_by(SIGTERM), 0);
  EXPECT_EQ(agent.ends_by(SIGINT), 0);
  EXPECT_EQ(service.ends_by(SIGTERM), 1);  // not every robot has arrived
  EXPECT_NE(test::contents(service.log).find("interrupted"), std::string::npos);
}

}  // namespace
}  // namespace coppice
