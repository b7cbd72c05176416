// Tests of the page of a real monitor, for a driving fleet and for a recording, as a user works with it: in
// Debian's chromium, driven by playwright-core. tests/run installs both.
//
// COPPICE_PAGE_SHOTS: a folder in which the screenshots stay.
//
// CTest: TIMEOUT 900
// CTest: RESOURCE_LOCK browser_2

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"
#include "tests/web/packages.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

struct Page : testing::Test {
  void SetUp() override { ASSERT_EQ(test::missing_for_browser(), ""); }

  std::filesystem::path path(const std::string& name) const { return folder.path() / name; }
  std::unique_ptr<test::Background> start(std::vector<std::string> arguments, const std::string& log) const {
    arguments.insert(arguments.begin(), test::program("coppice"));
    return std::make_unique<test::Background>(arguments, path(log));
  }
  /// The address in the monitor's first line.
  std::string url() const {
    const auto line = [&] {
      const std::string said = test::contents(path("monitor.log"));
      return said.starts_with("http://") ? said.substr(0, said.find('\n')) : std::string();
    };
    EXPECT_TRUE(test::within(20s, [&] { return !line().empty(); })) << test::contents(path("monitor.log"));
    return line();
  }
  /// Runs a script of page/ at the monitor's page.
  void run_spec(const std::string& script, const std::string& arguments = {}) const {
    const test::Outcome outcome =
        test::shell(fmt::format("COPPICE_PAGE_URL={} node '{}/page/{}' {} 2>&1", url(),
                                test::web_tests().string(), script, arguments));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output << test::contents(path("monitor.log"));
  }
  void use_page(const std::string& of_what) const {
    const char* const kept = std::getenv("COPPICE_PAGE_SHOTS");
    const std::string shots = kept != nullptr ? std::string(kept) + "/" + of_what : path("shots").string();
    const test::Outcome outcome = test::shell(
        fmt::format("COPPICE_PAGE_URL={} COPPICE_PAGE_SHOTS='{}' node '{}/page/page.spec.mjs' 2>&1", url(),
                    shots, test::web_tests().string()));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output << test::contents(path("monitor.log"));
    EXPECT_TRUE(std::filesystem::exists(shots + "/light.png"));
  }

  test::TemporaryFolder folder;
};

TEST_F(Page, ThePageShowsADrivingFleet) {
  const auto monitor = start({"monitor", "--domain", test::domain_name(), "--port", "0"}, "monitor.log");
  const auto run = start({"run", (test::scenarios() / "rooms-20.json").string(), "--domain",
                          test::domain_name(), "--quiet", "--time-scale", "1", "--lifelong", "200"},
                         "run.log");
  use_page("fleet");
  EXPECT_FALSE(test::has_ended(run->pid()))
      << "the fleet must drive all the time: " << test::contents(path("run.log"));
  run->send(SIGINT);
  run->wait();
}

TEST_F(Page, AnOperatorControlsAFleetWithThePage) {
  const std::string number = test::domain_name();
  const std::string token = "0123456789abcdef";
  folder.write("token", token);
  const auto fleet =
      start({"serve", (test::scenarios() / "rooms-8.json").string(), "--robots", "4", "--domain", number,
             "--quiet", "--time-scale", "2", "--state", path("state").string()},
            "fleet.log");
  const auto monitor = start(
      {"monitor", "--domain", number, "--port", "0", "--control", "--token-file", path("token").string()},
      "monitor.log");
  const char* const kept = std::getenv("COPPICE_PAGE_SHOTS");
  const test::Outcome outcome = test::shell(
      fmt::format("COPPICE_PAGE_URL={} COPPICE_PAGE_TOKEN={} COPPICE_PAGE_SHOTS='{}' node "
                  "'{}/page/fleet_control.spec.mjs' 2>&1",
                  url(), token, kept != nullptr ? std::string(kept) + "/control" : path("shots").string(),
                  test::web_tests().string()));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output << test::contents(path("monitor.log"))
                                  << test::contents(path("fleet.log"));
}

TEST_F(Page, WhatHangsIsSeenOnThePage) {
  const std::string number = test::domain_name();
  const std::string token = "0123456789abcdef";
  folder.write("token", token);
  const auto fleet = start({"serve", (test::scenarios() / "rooms-8.json").string(), "--robots", "4",
                            "--domain", number, "--quiet", "--state", path("state").string()},
                           "fleet.log");
  const auto monitor = start(
      {"monitor", "--domain", number, "--port", "0", "--control", "--token-file", path("token").string()},
      "monitor.log");
  const auto agent_of_r2 = [&] {
    for (const test::ProcessInfo& process : test::children_of(fleet->pid())) {
      std::string command = test::contents(fmt::format("/proc/{}/cmdline", process.pid));
      std::ranges::replace(command, '\0', ' ');
      if (command.find("--name r2 ") != std::string::npos) return process.pid;
    }
    return pid_t{0};
  };
  ASSERT_TRUE(test::within(20s, [&] { return agent_of_r2() != 0; })) << test::contents(path("fleet.log"));
  const char* const kept = std::getenv("COPPICE_PAGE_SHOTS");
  const test::Outcome outcome = test::shell(
      fmt::format("COPPICE_PAGE_URL={} COPPICE_PAGE_TOKEN={} COPPICE_PAGE_SHOTS='{}' node "
                  "'{}/page/hanging.spec.mjs' {} {} 2>&1",
                  url(), token, kept != nullptr ? std::string(kept) + "/hanging" : path("shots").string(),
                  test::web_tests().string(), monitor->pid(), agent_of_r2()));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output << test::contents(path("monitor.log"))
                                  << test::contents(path("fleet.log"));
}

TEST_F(Page, ThePageShowsARecording) {
  const std::string file = path("fleet.mcap").string();
  // A simulated fleet's recording begins when its time does. A loaded machine's recorder may begin later.
  EXPECT_EQ(start({"simulate", (test::scenarios() / "rooms-8.json").string(), "--quiet", "--lifelong", "15",
                   "--record", file},
                  "run.log")
                ->wait(),
            0)
      << test::contents(path("run.log"));
  const auto monitor = start({"monitor", file, "--port", "0"}, "monitor.log");
  run_spec("recording.spec.mjs");
}

TEST_F(Page, ThePageShowsTheOutcomeAndTheRobotsThatArrived) {
  const auto run = start({"run", (test::scenarios() / "rooms-8.json").string(), "--robots", "2", "--domain",
                          test::domain_name(), "--quiet", "--time-scale", "0.4", "--watch"},
                         "monitor.log");
  run_spec("end_of_run.spec.mjs", "2");
  EXPECT_EQ(run->wait(), 0) << test::contents(path("monitor.log"));
  const std::string said = test::contents(path("monitor.log"));
  const std::regex warning("r[12]: warning: missed [^\n]* it gets too little processor time\n");
  const std::string expected = std::regex_replace(said, warning, "");
  EXPECT_EQ(std::ranges::count(expected, '\n'), 1) << "one line, with the address: " << said;
}

/// No fleet is alive on the bus of `coppice replay`.
TEST_F(Page, ThePageNeverCallsAReplayLive) {
  const std::string file = path("fleet.mcap").string();
  EXPECT_EQ(start({"simulate", (test::scenarios() / "rooms-8.json").string(), "--robots", "2", "--quiet",
                   "--record", file},
                  "simulate.log")
                ->wait(),
            0)
      << test::contents(path("simulate.log"));
  const std::string number = test::domain_name();
  const auto monitor = start({"monitor", "--domain", number, "--port", "0"}, "monitor.log");
  test::Background spec(
      {"/usr/bin/env", "COPPICE_PAGE_URL=" + url(), "node", test::web_tests() / "page/badge.spec.mjs",
       "waiting for a fleet", "replay", "fleet silent since "},
      path("spec.log"));
  const auto is_shown = [&](const std::string& text) {
    return test::within(
        60s, [&] { return test::contents(path("spec.log")).find(text + "\n") != std::string::npos; });
  };
  ASSERT_TRUE(is_shown("waiting for a fleet"));
  const auto replay = start({"replay", file, "--domain", number}, "replay.log");
  ASSERT_TRUE(is_shown("replay"));
  replay->send(SIGINT);
  EXPECT_EQ(spec.wait(), 0) << test::contents(path("spec.log")) << test::contents(path("monitor.log"));
}

TEST_F(Page, ThePageShowsPositionsOfFarMapsToAMillimetre) {
  folder.write("far.pgm", "P5 40 20 255\n" + std::string(800, '\xff'));
  folder.write("far.yaml",
               "image: far.pgm\nresolution: 0.5\norigin: [500000.0, 5400000.0, 0.0]\nnegate: 0\n"
               "occupied_thresh: 0.65\nfree_thresh: 0.19\n");
  folder.write("far.json", R"({"map": "far.yaml", "radius": 0.5, "max_speed": 1, "robots": [
      {"name": "r1", "start": {"x": 500002, "y": 5400002}, "goal": {"x": 500018, "y": 5400008}}]})");
  const std::string file = path("far.mcap").string();
  EXPECT_EQ(start({"simulate", path("far.json").string(), "--quiet", "--record", file, "--trajectory",
                   path("far.csv").string()},
                  "simulate.log")
                ->wait(),
            0)
      << test::contents(path("simulate.log"));
  const auto monitor = start({"monitor", file, "--port", "0"}, "monitor.log");
  run_spec("far_map.spec.mjs", "'" + path("far.csv").string() + "'");
}

}  // namespace
}  // namespace coppice
