// Tests of fleets of a few robots on small grids with passages one robot wide: all robots arrive, and none
// touches anything.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/arrangements.h"

namespace coppice {
namespace {

/// Robots with a radius of `radius` cells that drive one cell a second.
void expect_all_arrive(const test::Arrangement& a, double radius, std::uint32_t seed) {
  SCOPED_TRACE(test::drawing(a) + "radius " + std::to_string(radius));
  Scenario scenario{.map_name = "small", .map = a.map(1), .seed = seed, .robots = {}};
  for (std::size_t k = 0; k < a.starts.size(); ++k)
    scenario.robots.push_back(
        {"r" + std::to_string(k + 1), a.centre(a.starts[k], 1), a.centre(a.goals[k], 1), radius, 1, 2, 0.1});
  FleetSimulation simulation(scenario, {.timeout = 600});
  simulation.run([](const PlannerService&, double) { return true; });
  EXPECT_EQ(simulation.service().report().outcome(), "arrived");
  EXPECT_TRUE(broken_invariants(scenario, simulation).empty());
}

TEST(SmallArrangements, AllRobotsArriveInEveryOrientationOfTheMap) {
  for (const test::Arrangement& known : test::known_arrangements()) {
    double radius = 0.3;
    for (const test::Arrangement& a : test::all_symmetries(known)) {
      expect_all_arrive(a, radius, 1);
      radius += 0.027;
    }
  }
}

TEST(SmallArrangements, AllRobotsArriveIfAnExhaustiveSearchFindsAPlan) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const test::Arrangement a = test::drawn_arrangement(random);
    expect_all_arrive(a, random.uniform(0.3, 0.49), seed);
  }
}

}  // namespace
}  // namespace coppice
