#include <iostream>

#include <unistd.h>

#include "bus/process.h"
#include "coppice/commands.h"
#include "files/report_file.h"
#include "planner_service/progress.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

int simulate_command(const RunOptions& options) {
  const Scenario scenario = read_scenario(options.scenario, options.overrides);
  install_stop_signals();
  FleetSimulation simulation(scenario, {.timeout = options.timeout,
                                        .planner = chosen_planner(options),
                                        .plan_budget = options.plan_budget.value_or(default_plan_budget)});
  ProgressDisplay display(std::cout, ::isatty(STDOUT_FILENO) == 1);
  Progress last;
  simulation.run([&](const PlannerService& service, double now) {
    last = service.progress(now);
    display.show(last, wall_now());
    return !stop_requested();
  });
  display.finish(last);
  const PlannerService& service = simulation.service();
  const proto::Report report = service.report();
  write_results(options, report, service.tracks(), service.picture());
  if (!options.quiet) std::cout << '\n' << report_table(report);
  return service.everybody_arrived() ? 0 : 1;
}

}  // namespace coppice
