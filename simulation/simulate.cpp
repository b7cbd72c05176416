#include "coppice/simulation/simulate.h"

#include "files/report_file.h"
#include "simulation/check_simulation.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"

namespace coppice {

SimulatedRun simulate(const Scenario& scenario, const SimulationSettings& settings,
                      const std::function<bool(double)>& stop) {
  check_simulation(scenario, settings);
  FleetSimulation simulation(scenario, settings);
  simulation.run([&](const PlannerService&, double now) { return !stop || !stop(now); });
  const proto::Report report = simulation.service().report(in_parts(simulation.tracks()));
  SimulatedRun run{.arrived = report.outcome() == "arrived",
                   .run_time = report.run_time(),
                   .report = report_json(report),
                   .broken = broken_invariants(scenario, simulation)};
  for (const NamedTrack& track : simulation.tracks()) run.tracks.push_back(track.track);
  return run;
}

}  // namespace coppice
