// A fleet of real processes on several hosts, and what its run must fulfil.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/files/scenario_file.h"
#include "files/report_file.h"
#include "tests/network/hosts.h"
#include "tests/run_expectations.h"
#include "tests/support.h"

namespace coppice::test {

struct FleetOptions {
  std::string scenario;  ///< a name in scenarios/ without its ending
  std::size_t robots = 0;
  std::string discovery{};
  double time_scale = 1;
  double timeout = 300;  ///< fleet seconds
};

/// Agents are distributed over the hosts in turn. The service is on the first host and the broker on the
/// last.
class FleetOnHosts {
 public:
  FleetOnHosts(const Hosts& hosts, const FleetOptions& options) : options_(options) {
    scenario_ = read_scenario(scenarios() / (options.scenario + ".json"), {});
    scenario_.robots.resize(options.robots);
    for (const std::string ending : {".map", ".json"})
      std::filesystem::copy_file(scenarios() / (options.scenario + ending), file(options.scenario + ending));
    write_scenario(file(options.scenario + ".json"), scenario_);
    start(hosts, hosts.size() - 1, {"tree_broker"});
    for (std::size_t k = 0; k < scenario_.robots.size(); ++k)
      start(hosts, k % hosts.size(), {"robot_agent", "--name", scenario_.robots[k].name});
    start(hosts, 0,
          {"planner_service", file(options.scenario + ".json").string(), "--time-scale",
           std::to_string(options.time_scale), "--timeout", std::to_string(options.timeout), "--report",
           file("report.json").string(), "--trajectory", file("trajectory.csv").string()});
  }

  std::string says() const { return contents(logs_.back()); }
  /// The end of the log, for the message of a failure.
  std::string log_end() const {
    const std::string all = says();
    return all.substr(all.size() - std::min<std::size_t>(all.size(), 2000));
  }
  /// Whether the service prints the text within the time.
  bool says(const std::string& text, std::chrono::seconds time) const {
    return within(time, [&] { return says().find(text) != std::string::npos; });
  }
  bool all_have_paths(std::chrono::seconds time) const {
    const std::string n = std::to_string(options_.robots);
    return says("paths found " + n + "/" + n, time);
  }
  bool all_have_arrived() const {
    const std::string n = std::to_string(options_.robots);
    return says().find("arrived " + n + "/" + n) != std::string::npos;
  }

  /// Waits for the end and checks it: all robots arrived, nothing was touched, and the report agrees with the
  /// trajectory.
  void expect_good_end() {
    EXPECT_EQ(processes_.back()->wait(), 0) << log_end();
    const proto::Report report = read_report(file("report.json"));
    EXPECT_EQ(report.outcome(), "arrived");
    std::vector<Expected> robots;
    for (const RobotTask& task : scenario_.robots)
      robots.push_back({task.name, {task.start.x(), task.start.y()}, {task.goal.x(), task.goal.y()}});
    const double radius = scenario_.robots[0].radius;
    const PlainMap map(file(options_.scenario + ".map"));
    expect_good_paths(report, robots, radius, map);
    expect_good_motion(report, file("trajectory.csv"), radius, map);
    const auto tracks = read_trajectory_rows(file("trajectory.csv"));
    for (const Expected& robot : robots) {
      EXPECT_LE(distance(tracks.at(robot.name).front().place, robot.start), 0.5) << robot.name;
      EXPECT_LE(distance(tracks.at(robot.name).back().place, robot.goal), 1 + tolerance) << robot.name;
    }
    const std::filesystem::path check = std::filesystem::path(COPPICE_SHARED_DIR) / "check_run.py";
    if (std::filesystem::exists(check)) {
      const Outcome outcome =
          shell("python3 " + check.string() + " " + file(options_.scenario + ".json").string() + " " +
                file("trajectory.csv").string() + " " + file("report.json").string());
      EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
      std::cout << outcome.output;
    }
    if (testing::Test::HasFailure()) keep();
  }

  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }

 private:
  void start(const Hosts& hosts, std::size_t host, std::vector<std::string> command) {
    command[0] = program(command[0]);
    if (!options_.discovery.empty()) command.insert(command.begin() + 1, {"--discovery", options_.discovery});
    logs_.push_back(file("log" + std::to_string(logs_.size())));
    processes_.push_back(hosts.start(host, command, logs_.back()));
  }

  /// Keeps the files for an investigation.
  void keep() const {
    const auto kept = std::filesystem::path(COPPICE_TEST_BIN_DIR) / "failed" /
                      testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(kept);
    std::filesystem::create_directories(kept.parent_path());
    std::filesystem::copy(folder_.path(), kept);
    std::cout << "kept in " << kept << '\n';
  }

  FleetOptions options_;
  TemporaryFolder folder_;
  Scenario scenario_;
  std::vector<std::filesystem::path> logs_;
  std::vector<std::unique_ptr<Background>> processes_;
};

}  // namespace coppice::test
