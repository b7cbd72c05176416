// Simulates a fleet under faults: simulate_fleet SCENARIO. Prints when and where each robot stood still at
// last.

#include <cstdio>
#include <exception>

#include <coppice/files/scenario_file.h>
#include <coppice/simulation/simulate.h>

int main(int argc, char** argv) try {
  if (argc != 2) throw std::invalid_argument("usage: simulate_fleet SCENARIO");
  const coppice::Scenario scenario = coppice::read_scenario(argv[1], {});
  coppice::SimulationSettings settings{.timeout = 600};
  settings.faults.bus.loss = 0.1;
  settings.faults.bus.delay = 0.05;

  const coppice::SimulatedRun run = coppice::simulate(scenario, settings);
  for (std::size_t i = 0; i < run.tracks.size(); ++i) {
    const coppice::TrackPoint& last = run.tracks[i].points.back();
    std::printf("%s: (%.1f, %.1f) at %.2f s\n", scenario.robots[i].name.c_str(), last.position.x(),
                last.position.y(), last.time);
  }
  std::printf("%s, run time %.2f s\n", run.arrived ? "all arrived" : "not all arrived", run.run_time);
  return run.arrived && run.broken.empty() ? 0 : 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "%s\n", problem.what());
  return 2;
}
