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
#include "files/pose_file.h"
#include "files/report_file.h"
#include "files/run_options.h"
#include "files/temporary_folder.h"
#include "planner_service/options.h"
#include "planner_service/run/fleet_memory.h"
#include "planner_service/run/planner_service.h"
#include "planner_service/run/progress.h"
#include "planner_service/run/service_loop.h"
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

std::unique_ptr<DdsRosFleet> ros_of(const RosOptions& options, DdsBus& bus, const Scenario& scenario,
                                    ProcessClock& clock) {
  if (!options.on) return nullptr;
  auto ros = std::make_unique<DdsRosFleet>(bus, options.robot.names, names_of(scenario));
  ros->publish(scenario.map, clock.by_system(clock.now()));
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
                     const std::string& black_boxes, WallTime now) {
  for (const RobotName& robot : robots) {
    try {
      if (auto rest = rest_of_track(black_boxes, robot)) service.complete(*std::move(rest), now);
    } catch (const std::exception& error) {
      spdlog::warn("the end of the track of {} is not known: {}", robot, error.what());
    }
  }
}

/// Where the robots of a standing fleet begin a new run.
void choose_starts(const ServiceOptions& options, const Scenario& scenario, const FleetMemory& memory,
                   ServiceSettings& settings) {
  settings.starts_are_given = !options.start_at.empty();
  settings.starts = settings.starts_are_given ? read_poses(options.start_at, scenario) : memory.poses;
  if (!settings.starts_are_given) check_saved_poses(scenario, memory.poses);
  for (const std::string& line : warnings_of_starts(scenario, settings.starts)) spdlog::warn("{}", line);
  if (settings.starts_are_given) return;
  for (const RobotTask& robot : scenario.robots) {
    if (!memory.poses.empty() && pose_of(memory.poses, robot.name) == nullptr)
      spdlog::info("{} is new to this fleet: it starts at ({:g}, {:g}), as the scenario says", robot.name,
                   robot.start.x(), robot.start.y());
  }
}

/// A service, its bus, and what was saved of the fleet.
class FleetProcess {
 public:
  /// `journal`: null: nothing is saved.
  FleetProcess(const ServiceOptions& options, const Scenario& scenario, Journal* journal)
      : options_(options),
        scenario_(scenario),
        journal_(journal),
        clock_(options.process.state),
        bus_(options.process.network, Role::service, "planner_service"),
        heart_(options.process.alive),
        ros_(ros_of(options.ros, bus_, scenario, clock_)),
        loop_(bus_, heart_, clock_, draw_identity(), names_of(scenario), options.process.network.domain) {}

  /// Runs the fleet and writes the results. True if the run succeeded.
  bool run() {
    const StartupBarrier heard = begin();
    Keeper keeper(std::move(saved_), journal_);
    heard.for_each([&](const Arrival& arrival) {
      keeper.heard(*arrival.message);
      service_->on(arrival);
    });
    serve(keeper);
    if (!options_.black_boxes.empty())
      complete_tracks(*service_, names_of(scenario_), options_.black_boxes, clock_.now());
    const proto::Report report = service_->report();
    if (!options_.run.quiet) std::cout << '\n' << report_table(report) << std::flush;
    write_results(options_.run, report, service_->tracks(), [&] { return service_->picture(); });
    keep_for_the_next_run();
    loop_.check_precedence();
    // A fleet that takes orders ends when it is told to, and robots may be under way.
    return options_.run.serves || service_->succeeded();
  }

 private:
  bool stands_up_again() const { return options_.run.serves && !options_.process.state.empty(); }

  /// Goes on with the run in the journal, or begins a new one once all agents can hear of it. Returns what
  /// was heard meanwhile.
  StartupBarrier begin() {
    const WallTime began = clock_.now();
    if (stands_up_again()) memory_ = remembered_in(options_.process.state);
    if (journal_ != nullptr && !journal_->empty()) {
      make_service({}, began);
      loop_.resume(*service_, *journal_, saved_);
      if (!service_->recalls_an_end() || !stands_up_again()) {
        loop_.goes_on_with(service_->run().value_or(RunId{}));
        return loop_.wait_for_other_services();
      }
      // The service before this one was killed as it ended the fleet.
      keep_for_the_next_run();
      journal_->begin_anew();
      memory_ = remembered_in(options_.process.state);
    }
    ServiceSettings starts;
    if (options_.run.serves) choose_starts(options_, scenario_, memory_, starts);
    StartupBarrier heard = loop_.wait_for_agents();
    make_service(starts, began);
    return heard;
  }

  void make_service(const ServiceSettings& starts, WallTime began) {
    const std::string& state = options_.process.state;
    auto tracks =
        TrackRecord::on_disk(state.empty() ? place_for_temporary_files() : std::filesystem::path(state));
    ServiceSettings settings = settings_of(options_.run, options_.ros, scenario_);
    settings.starts = starts.starts;
    settings.starts_are_given = starts.starts_are_given;
    service_.reset();
    service_ = std::make_unique<PlannerService>(scenario_, settings, clock_.now(), std::move(tracks));
    service_->takes_orders_since(began);
    service_->remember(memory_);
    saved_ = RunKeeper();
    saved_.recall(memory_);
  }

  void serve(Keeper<RunKeeper, Journal>& keeper) {
    ProgressDisplay display(std::cout, ::isatty(STDOUT_FILENO) == 1);
    std::optional<OrderHistory> history;
    if (stands_up_again()) history.emplace(std::filesystem::path(options_.process.state) / "orders.jsonl");
    loop_.serve(*service_, keeper, history ? &*history : nullptr, ros_.get(),
                options_.run.quiet ? nullptr : &display);
  }

  void keep_for_the_next_run() {
    if (stands_up_again()) remember(options_.process.state, service_->memory(), scenario_);
  }

  const ServiceOptions& options_;
  const Scenario& scenario_;
  Journal* journal_;
  ProcessClock clock_;
  DdsBus bus_;
  Heartbeat heart_;
  std::unique_ptr<DdsRosFleet> ros_;
  ServiceLoop loop_;
  FleetMemory memory_;
  RunKeeper saved_;
  std::unique_ptr<PlannerService> service_;
};

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
  auto journal = open_journal(options.process.state, options.run.serves);
  const bool succeeded = FleetProcess(options, scenario, journal ? &*journal : nullptr).run();
  // Last of all: a process that is killed before this and restarted ends the same run again, and begins no
  // new one.
  if (journal) journal->remove();
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
