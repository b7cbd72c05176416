#include <algorithm>
#include <iostream>

#include <unistd.h>

#include "coppice/commands.h"
#include "coppice/files/input_error.h"
#include "coppice/simulate/simulation_recording.h"
#include "files/report_file.h"
#include "planner_service/run/progress.h"
#include "runtime/process.h"
#include "simulation/drive_limits.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"

namespace coppice {

int simulate_command(const RunOptions& options, const Faults& faults, const NewRecording& record) {
  ScenarioOptions read = scenario_options(options);
  read.follow = is_any(faults.drive);
  Scenario scenario = read_scenario(options.scenario, read);
  if (read.follow && !read.tracking_tolerance) fit_to_drive(faults.drive, scenario);
  check_results(options, scenario, record.file);
  for (const Faults::Kill& kill : faults.kills) {
    if (std::ranges::count(scenario.robots, kill.robot, &RobotTask::name) == 0)
      throw InputError(options.scenario + ": --kill: there is no robot " + kill.robot);
  }
  check_drive(faults.drive, scenario);
  install_stop_signals();
  FleetSimulation simulation(scenario, {.timeout = options.timeout,
                                        .planner = chosen_planner(options),
                                        .plan_budget = options.plan_budget.value_or(default_plan_budget),
                                        .lifelong = options.lifelong,
                                        .faults = faults,
                                        .trees = chosen_trees(options),
                                        .forest = chosen_forest(options),
                                        .plan = chosen_plan(options, scenario),
                                        .coordination = chosen_coordination(options)});
  SimulationRecording recording(simulation, record);
  ProgressDisplay display(std::cout, ::isatty(STDOUT_FILENO) == 1);
  Progress last;
  ProcessClock clock;
  simulation.run([&](const PlannerService& service, double now) {
    last = service.progress(now);
    if (!options.quiet) display.show(last, clock.now());
    return !stop_requested();
  });
  if (!options.quiet) display.finish(last);
  recording.finish();
  const PlannerService& service = simulation.service();
  const std::vector<NamedTrack>& tracks = simulation.tracks();
  const proto::Report report = service.report(in_parts(tracks));
  write_results(options, report, in_parts(tracks), [&] { return service.picture(); });
  if (!options.quiet) std::cout << '\n' << report_table(report);
  const auto broken = broken_invariants(scenario, simulation);
  for (const std::string& line : broken) std::cerr << line << '\n';
  return report.outcome() == "arrived" && broken.empty() ? 0 : 1;
}

}  // namespace coppice
