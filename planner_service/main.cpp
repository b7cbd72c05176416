// planner_service --domain D SCENARIO: hands out the missions of a scenario, shows progress, writes the
// report.

#include <iostream>
#include <optional>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "bus/dds_bus.h"
#include "bus/process.h"
#include "files/input_error.h"
#include "files/picture.h"
#include "files/report_file.h"
#include "files/run_options.h"
#include "files/scenario_file.h"
#include "planner_service/planner_service.h"
#include "planner_service/progress.h"

namespace {

using namespace coppice;

constexpr double worth_telling = 3;  // seconds

/// Until an agent for each robot, and a broker, can hear of its mission: those of a large fleet on few
/// processors meet sooner while none of them drives. Who has not come by then gets its mission when it does.
void wait_for_agents(DdsBus& bus, std::size_t robots) {
  const WallTime begin = wall_now();
  const WallTime latest = begin + 1 + 0.2 * static_cast<double>(robots);
  while (bus.matched_readers<Mission>() < robots + 1 && wall_now() < latest && !stop_requested())
    bus.wait(longest_wait);
  const double waited = wall_now() - begin;
  if (waited > worth_telling)
    spdlog::info("{} of {} processes have come after {:.1f} s", bus.matched_readers<Mission>(), robots + 1,
                 waited);
}

/// Exit code: 0 if every robot arrived.
int run(const RunOptions& options) {
  Scenario scenario = read_scenario(options.scenario, options.overrides);
  DdsBus bus(
      {.domain = options.domain.value_or(0), .discovery = options.discovery, .security = options.security},
      Role::service, "planner_service");
  wait_for_agents(bus, scenario.robots.size());
  PlannerService service(std::move(scenario),
                         {.time_scale = options.time_scale,
                          .timeout = options.timeout,
                          .planner = chosen_planner(options),
                          .plan_budget = options.plan_budget.value_or(default_plan_budget),
                          .lifelong = options.lifelong},
                         wall_now());
  ProgressDisplay display(std::cout, ::isatty(STDOUT_FILENO) == 1);
  while (!service.finished()) {
    if (stop_requested()) service.interrupt();
    run_role_once(bus, service);
    display.show(service.progress(wall_now()), wall_now());
  }
  display.finish(service.progress(wall_now()));
  const proto::Report report = service.report();
  write_results(options, report, service.tracks(), service.picture());
  if (!options.quiet) std::cout << '\n' << report_table(report);
  return service.everybody_arrived() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  RunOptions options;
  CLI::App app{"Coppice planner service: missions in, progress and a report out"};
  app.set_version_flag("--version", COPPICE_VERSION);
  add_run_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  set_up_logging("planner_service", "info");
  install_stop_signals();
  try {
    return run(options);
  } catch (const std::exception& problem) {
    std::cerr << problem.what() << '\n';
    return 2;
  }
}
