// Tests of a fleet whose host gets another time of day, as NTP and operators set it: backward and forward, by
// seconds and by an hour. libfaketime sets the clock of these processes alone.
//
// CTest: RESOURCE_LOCK lane_3

#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using test::Background;
using test::Outcome;

constexpr const char* library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1";

/// Two robots in a room of 30 m x 16 m.
std::string room() {
  std::string map = "type octile\nheight 16\nwidth 30\nmap\n";
  for (int j = 0; j < 16; ++j) map += std::string(30, '.') + '\n';
  return map;
}
constexpr const char* site = R"({"map": "room.map", "radius": 0.4, "max_speed": 2, "robots": [
  {"name": "r1", "start": {"x": 5, "y": 5}}, {"name": "r2", "start": {"x": 25, "y": 5}}]})";

class FleetUnderAClockStep : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(library)) GTEST_SKIP() << "libfaketime is not installed";
    if (!std::string(COPPICE_SANITIZER).empty()) GTEST_SKIP() << "sanitizers do not go with libfaketime";
    folder.write("room.map", room());
    folder.write("site.json", site);
    set_clock("+0");
    std::vector<std::string> command{"/usr/bin/env"};
    for (const std::string& variable : environment()) command.push_back(variable);
    command.insert(command.end(), {test::program("coppice"), "serve", file("site.json"), "--domain",
                                   test::domain_name(), "--state", file("state")});
    fleet = std::make_unique<Background>(command, file("log"));
  }
  std::string file(const std::string& name) const { return (folder.path() / name).string(); }
  std::vector<std::string> environment() const {
    return {std::string("LD_PRELOAD=") + library, "FAKETIME_TIMESTAMP_FILE=" + file("offset"),
            "FAKETIME_NO_CACHE=1", "FAKETIME_DONT_FAKE_MONOTONIC=1", "DONT_FAKE_MONOTONIC=1"};
  }
  void set_clock(const std::string& offset) const { folder.write("offset", offset + "\n"); }
  Outcome command(const std::string& words) const {
    std::string line = "env ";
    for (const std::string& variable : environment()) line += "'" + variable + "' ";
    return test::shell(line + "timeout 60 " + test::program("coppice") + " " + words + " --domain " +
                       test::domain_name());
  }
  void kill_one(const std::string& name) const {
    for (const test::ProcessInfo& child : test::children_of(fleet->pid())) {
      if (child.name != name || child.state == 'Z') continue;
      kill(child.pid, SIGKILL);
      return;
    }
    FAIL() << "no process " << name;
  }

  test::TemporaryFolder folder;
  std::unique_ptr<Background> fleet;
};

TEST_P(FleetUnderAClockStep, OrdersAreCarriedOutAlsoAfterRestarts) {
  const Outcome before = command("send r1 --to 12,5 --to 5,5 --patience 40");
  ASSERT_EQ(before.exit_code, 0) << before.output << test::contents(file("log"));
  std::this_thread::sleep_for(2s);
  set_clock(GetParam() < 0 ? std::to_string(GetParam()) : "+" + std::to_string(GetParam()));
  const Outcome after = command("send r2 --to 25,12 --wait --patience 20 --deadline 300");
  EXPECT_EQ(after.exit_code, 0) << after.output << test::contents(file("log"));
  EXPECT_EQ(after.output.find("late"), std::string::npos) << after.output;
  EXPECT_NE(after.output.find("done by r2"), std::string::npos) << after.output;
  const auto all = [&] { return command("orders --all").output; };
  EXPECT_TRUE(test::within(40s, [&] { return all().find("done by r1") != std::string::npos; })) << all();
  EXPECT_NE(test::contents(file("log")).find("the clock of the system was set by"), std::string::npos)
      << test::contents(file("log"));

  kill_one("robot_agent");
  kill_one("planner_service");
  kill_one("tree_broker");
  for (const std::string robot : {"r1 --to 12,12", "r2 --to 18,5"}) {
    const Outcome later = command("send " + robot + " --wait --patience 40");
    EXPECT_EQ(later.exit_code, 0) << later.output << test::contents(file("log"));
  }
}

INSTANTIATE_TEST_SUITE_P(BySeconds, FleetUnderAClockStep, testing::Values(-3600, -30, 30, 3600, 40'000'000),
                         [](const auto& step) {
                           return (step.param < 0 ? "back" : "forward") +
                                  std::to_string(std::abs(step.param));
                         });

}  // namespace
}  // namespace coppice
