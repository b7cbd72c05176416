// A robot was pushed to where no sampled path leads out. It must still reach its goal. Once it searched until
// it gave up, in the 7th of eight dense maps.
#include <gtest/gtest.h>

#include "bench/trial.h"
#include "simulation/fleet_simulation.h"

namespace coppice {
namespace {

TEST(Nook, ARobotPushedIntoANookGoesBackAlongItsTrail) {
  const TrialCase trial = make_case("dense", 512, 20, 5, 7);
  Scenario scenario{.map_name = "dense", .map = trial.occupancy, .seed = 7, .robots = {}};
  for (const PlanningProblem& p : trial.problems)
    scenario.robots.push_back(
        {"r" + std::to_string(scenario.robots.size() + 1), p.start, p.goal, 5, 20, 40, 1});
  FleetSimulation simulation(scenario, {.timeout = 1000});
  simulation.run([](const PlannerService&, double) { return true; });
  const std::vector<NamedTrack>& tracks = simulation.tracks();
  EXPECT_EQ(simulation.service().report(in_parts(tracks)).outcome(), "arrived");
}

}  // namespace
}  // namespace coppice
