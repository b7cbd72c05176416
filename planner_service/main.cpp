// planner_service --domain D SCENARIO: publishes the missions of a scenario, shows progress, and writes the
// report.

#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "coppice/files/scenario_file.h"
#include "dds/dds_bus.h"
#include "files/report_file.h"
#include "files/run_options.h"
#include "files/temporary_folder.h"
#include "planner_service/options.h"
#include "planner_service/planner_service.h"
#include "planner_service/progress.h"
#include "planner_service/service_loop.h"
#include "ros2/dds_ros.h"
#include "ros2/names.h"
#include "runtime/black_box.h"
#include "runtime/command_line.h"
#include "runtime/journal.h"
#include "runtime/process.h"

namespace {

using namespace coppice;

/// The identity of this process among services. Each start draws a new one, above 0.
std::uint64_t draw_identity() {
  std::random_device device;
  return (static_cast<std::uint64_t>(device()) << 32) | device() | 1u;
}

std::unique_ptr<DdsRosFleet> ros_of(const RosOptions& options, DdsBus& bus, const Scenario& scenario) {
  if (!options.on) return nullptr;
  auto ros = std::make_unique<DdsRosFleet>(bus, options.robot.names, names_of(scenario));
  ros->publish(scenario.map, wall_now());
  return ros;
}

ServiceSettings settings_of(const RunOptions& options, const RosOptions& in_ros, const Scenario& scenario) {
  return {.time_scale = options.time_scale.value_or(1),
          .timeout = options.timeout,
          .planner = chosen_planner(options),
          .trees = chosen_trees(options),
          .forest = chosen_forest(options),
          .plan_budget = options.plan_budget.value_or(default_plan_budget),
          .lifelong = options.lifelong,
          .waits_for_goals = options.serves,
          .plan = chosen_plan(options, scenario),
          .coordination = chosen_coordination(options),
          .robots_elsewhere = in_ros.drives(),
          .map_frame = in_ros.robot.names.map_frame};
}

/// The report comes also if a box cannot be read. Then the track ends as the agent sent it.
void complete_tracks(PlannerService& service, std::span<const RobotName> robots,
                     const std::string& black_boxes) {
  for (const RobotName& robot : robots) {
    try {
      if (auto rest = rest_of_track(black_boxes, robot)) service.complete(*std::move(rest), wall_now());
    } catch (const std::exception& error) {
      spdlog::warn("the end of the track of {} is not known: {}", robot, error.what());
    }
  }
}

/// Runs the fleet and writes the results. True if the run succeeded.
bool run_succeeds(const ServiceOptions& options, const Scenario& scenario, Journal* journal) {
  const ServiceSettings settings = settings_of(options.run, options.ros, scenario);
  const std::string& state = options.process.state;
  auto tracks =
      TrackRecord::on_disk(state.empty() ? place_for_temporary_files() : std::filesystem::path(state));
  DdsBus bus(options.process.network, Role::service, "planner_service");
  Heartbeat heart(options.process.alive);
  const auto ros = ros_of(options.ros, bus, scenario);
  const std::vector<RobotName> names = names_of(scenario);
  ServiceLoop loop(bus, heart, draw_identity(), names, options.process.network.domain);
  const bool resumes = journal != nullptr && !journal->empty();
  StartupBarrier heard;
  if (!resumes) heard = loop.wait_for_agents();
  PlannerService service(scenario, settings, wall_now(), std::move(tracks));
  Keeper keeper(resumes ? loop.resume(service, *journal) : RunKeeper(), journal);
  if (resumes) heard = loop.wait_for_other_services();
  heard.for_each([&](const Arrival& arrival) {
    keeper.heard(*arrival.message);
    service.on(arrival);
  });
  heard = StartupBarrier();  // it may hold the tracks of the run before
  ProgressDisplay display(std::cout, ::isatty(STDOUT_FILENO) == 1);
  std::optional<OrderHistory> history;
  if (options.run.serves && !state.empty()) history.emplace(std::filesystem::path(state) / "orders.jsonl");
  loop.serve(service, keeper, history ? &*history : nullptr, ros.get(),
             options.run.quiet ? nullptr : &display);
  if (!options.black_boxes.empty()) complete_tracks(service, names, options.black_boxes);
  const proto::Report report = service.report();
  if (!options.run.quiet) std::cout << '\n' << report_table(report) << std::flush;
  write_results(options.run, report, service.tracks(), [&] { return service.picture(); });
  loop.check_precedence();
  // A fleet that takes orders ends when it is told to, and robots may be under way.
  return options.run.serves || service.succeeded();
}

ScenarioOptions scenario_options(const ServiceOptions& options) {
  ScenarioOptions read = scenario_options(options.run);
  read.follow = options.ros.drives();
  read.tracking_tolerance = options.ros.tolerance;
  return read;
}

/// The exit code: 0 if the run succeeded.
int run(const ServiceOptions& options) {
  check_ros(options.ros, options.process.network.discovery, options.process.network.security);
  const Scenario scenario = read_scenario(options.run.scenario, scenario_options(options));
  check_results(options.run, scenario);
  if (options.ros.on) check_ros_names(options.ros.robot.names, names_of(scenario));
  if (!options.black_boxes.empty()) make_folder(options.black_boxes);
  auto journal = open_journal(options.process.state);
  const bool succeeded = run_succeeds(options, scenario, journal ? &*journal : nullptr);
  // Last of all: a process that is killed before this and restarted ends the same run again, and begins no
  // new one.
  if (journal) std::filesystem::remove(journal->file());
  return succeeded ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  fill_standard_streams();
  CLI::App app;
  ServiceOptions options;
  add_service_options(app, options);
  if (const auto exit_code = parse(app, argc, argv)) return *exit_code;
  set_up_logging("planner_service", options.process.log.level, options.process.log.json);
  install_stop_signals();
  return exit_code_of([&] { return run(options); });
}
