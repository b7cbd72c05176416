// planner_service --domain D SCENARIO: hands out the missions of a scenario, shows progress, writes the
// report.

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "bus/dds_bus.h"
#include "bus/discovery.h"
#include "bus/journal.h"
#include "bus/keep.h"
#include "bus/process.h"
#include "bus/process_options.h"
#include "files/input_error.h"
#include "files/picture.h"
#include "files/report_file.h"
#include "files/run_options.h"
#include "files/scenario_file.h"
#include "planner_service/claim_desk.h"
#include "planner_service/muster.h"
#include "planner_service/planner_service.h"
#include "planner_service/progress.h"
#include "planner_service/run_record.h"

namespace {

using namespace coppice;

constexpr double worth_telling = 3;  // seconds

/// Until an agent for each robot, and a broker, can hear of its mission, and those of a large fleet have
/// found each other: on few processors they do so sooner while none of them drives. Who has not come by then
/// gets its mission when it does.
Muster wait_for_agents(DdsBus& bus, ClaimDesk& desk, Heartbeat& heart, std::size_t robots) {
  KeepsNothing keeper;
  const WallTime begin = wall_now();
  const WallTime latest = begin + 1 + 0.2 * static_cast<double>(robots);
  Muster heard;
  const auto all_are_there = [&] {
    const bool met = std::cmp_less(robots, large_fleet) || heard.acquainted(robots - 1) >= robots;
    return met && bus.matched_readers<Mission>() >= robots + 1;
  };
  while (!all_are_there() && wall_now() < latest && !stop_requested()) {
    bus.wait(longest_wait);
    for (Arrival& arrival : bus.take()) {
      desk.on(arrival);
      heard.add(std::move(arrival));
    }
    step_role(bus, desk, keeper);
    heart.beat(wall_now());
  }
  const double waited = wall_now() - begin;
  if (waited > worth_telling)
    spdlog::info("after {:.1f} s {} of {} processes have come, and {} agents have found all others", waited,
                 bus.matched_readers<Mission>(), robots + 1, heard.acquainted(robots - 1));
  return heard;
}

std::vector<RobotName> names_of(const Scenario& scenario) {
  std::vector<RobotName> names;
  for (const RobotTask& robot : scenario.robots) names.push_back(robot.name);
  return names;
}

/// What a service that was killed has kept of its run.
std::vector<Message> recalled(std::optional<Journal>& journal) {
  if (!journal) return {};
  if (!journal->complete())
    throw InputError(
        journal->file().string() +
        ": the disk was full when it was written, so that the run cannot go on from it: remove it");
  return journal->take_recalled();
}

/// Where there is room for what is kept, if that is told.
std::filesystem::path folder_for_tracks(const ProcessOptions& process) {
  return process.state.empty() ? std::filesystem::temp_directory_path()
                               : std::filesystem::path(process.state);
}

/// The service and its desk on one bus, until the run has ended.
void serve(DdsBus& bus, PlannerService& service, ClaimDesk& desk, Keeper<RunRecord, Journal>& keeper,
           Heartbeat& heart) {
  KeepsNothing of_desk;
  ProgressDisplay display(std::cout, ::isatty(STDOUT_FILENO) == 1);
  while (!service.finished()) {
    if (stop_requested()) service.interrupt();
    bus.wait(std::clamp(std::min(service.next_wake(), desk.next_wake()) - wall_now(), 0.0, longest_wait));
    for (const Arrival& arrival : bus.take()) {
      keeper.heard(*arrival.message);
      service.on(arrival);
      desk.on(arrival);
    }
    step_role(bus, service, keeper);
    step_role(bus, desk, of_desk);
    heart.beat(wall_now());
    display.show(service.progress(wall_now()), wall_now());
  }
  display.finish(service.progress(wall_now()));
}

/// Exit code: 0 if every robot arrived.
int run(const RunOptions& options, const ProcessOptions& process) {
  Scenario scenario = read_scenario(options.scenario, options.overrides);
  auto journal = journal_in(process.state, "planner_service");
  const std::vector<Message> kept = recalled(journal);
  DdsBus bus(process.network, Role::service, "planner_service");
  Heartbeat heart(process.alive);
  ClaimDesk desk(names_of(scenario), wall_now());
  Muster heard;
  if (kept.empty()) heard = wait_for_agents(bus, desk, heart, scenario.robots.size());
  PlannerService service(std::move(scenario),
                         {.time_scale = options.time_scale.value_or(1),
                          .timeout = options.timeout,
                          .planner = chosen_planner(options),
                          .plan_budget = options.plan_budget.value_or(default_plan_budget),
                          .lifelong = options.lifelong},
                         wall_now(), TrackRecord::on_disk(folder_for_tracks(process)));
  if (!service.recall(kept, wall_now()))
    throw InputError(journal->file().string() +
                     ": is of another run: end that one, remove the file, or name another folder");
  heard.for_each([&](const Arrival& arrival) { service.on(arrival); });
  RunRecord record;
  record.recall(kept);
  Keeper keeper(std::move(record), journal ? &*journal : nullptr);
  serve(bus, service, desk, keeper, heart);
  const proto::Report report = service.report();
  write_results(options, report, service.tracks(), [&] { return service.picture(); });
  if (journal) std::filesystem::remove(journal->file());  // the run is over
  if (!options.quiet) std::cout << '\n' << report_table(report);
  return service.everybody_arrived() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  RunOptions options;
  ProcessOptions process;
  CLI::App app{"Coppice planner service: missions in, progress and a report out"};
  app.set_version_flag("--version", COPPICE_VERSION);
  add_run_options(app, options);
  add_process_options(app, process);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  set_up_logging("planner_service", process.log_level, process.log_json);
  install_stop_signals();
  try {
    return run(options, process);
  } catch (const std::exception& problem) {
    std::cerr << problem.what() << '\n';
    return 2;
  }
}
