#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <thread>

#include <unistd.h>

#include <fmt/format.h>

#include "bus/process.h"
#include "coppice/commands.h"
#include "coppice/process_fleet.h"
#include "files/report_file.h"
#include "files/scenario_file.h"

namespace coppice {

namespace {

constexpr std::chrono::milliseconds grace{3000};
constexpr std::chrono::milliseconds poll_period{10};

/// A folder of its own for logs and the report, removed at the end.
class RunFolder {
 public:
  RunFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "coppice-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder can be made");
    path_ = name;
  }
  ~RunFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Another domain for each run, so that two on one machine do not meet; above 100 the default ports stay below those
/// that Linux hands out to others.
int own_domain() { return 1 + static_cast<int>(static_cast<unsigned>(getpid()) % 99); }

std::vector<std::string> service_command(const RunOptions& options, const std::string& program, int domain) {
  std::vector<std::string> command{program, options.scenario, "--domain", std::to_string(domain)};
  const auto add = [&](const std::string& name, const std::string& value) {
    command.push_back(name);
    command.push_back(value);
  };
  if (options.overrides.robots) add("--robots", std::to_string(*options.overrides.robots));
  if (options.overrides.radius) add("--radius", fmt::format("{}", *options.overrides.radius));
  if (options.overrides.max_speed) add("--max-speed", fmt::format("{}", *options.overrides.max_speed));
  if (options.overrides.seed) add("--seed", std::to_string(*options.overrides.seed));
  add("--time-scale", fmt::format("{}", options.time_scale));
  add("--timeout", fmt::format("{}", options.timeout));
  if (!options.report.empty()) add("--report", options.report);
  if (!options.trajectory.empty()) add("--trajectory", options.trajectory);
  if (!options.picture.empty()) add("--picture", options.picture);
  if (options.no_sharing) command.emplace_back("--no-sharing");
  if (options.quiet) command.emplace_back("--quiet");
  return command;
}

void tell_of_end(const ProcessFleet::Ended& ended) {
  std::cerr << fmt::format("{} ended early, exit code {}{}{}\n", ended.name, ended.exit_code,
                           ended.last_words.empty() ? "" : ": ", ended.last_words);
}

}  // namespace

int run_command(const RunOptions& options, const std::string& program) {
  const Scenario scenario = read_scenario(options.scenario, options.overrides);  // bad input: before anything starts
  install_stop_signals();
  remove_stale_shared_memory();
  const std::filesystem::path folder = std::filesystem::canonical(program).parent_path();
  const int domain = options.domain.value_or(own_domain());
  const std::vector<std::string> on_domain{"--domain", std::to_string(domain)};
  const RunFolder run_folder;
  ProcessFleet fleet(run_folder.path());

  fleet.start("tree_broker", {(folder / "tree_broker").string(), on_domain[0], on_domain[1], "--seed",
                              std::to_string(scenario.seed)}, ProcessFleet::Output::log);
  for (const RobotTask& robot : scenario.robots) {
    fleet.start(robot.name, {(folder / "robot_agent").string(), "--name", robot.name, on_domain[0], on_domain[1]},
                ProcessFleet::Output::log);
  }
  const std::string service = "planner_service";
  fleet.start(service, service_command(options, (folder / service).string(), domain), ProcessFleet::Output::terminal);

  bool asked = false;
  while (true) {
    if (stop_requested() && !asked) {
      fleet.terminate(service);
      asked = true;
    }
    const auto ended = fleet.reap();
    if (!ended) {
      std::this_thread::sleep_for(poll_period);
    } else if (ended->name == service) {
      fleet.terminate_all(grace);
      return ended->exit_code;
    } else {
      tell_of_end(*ended);
    }
  }
}

}  // namespace coppice
