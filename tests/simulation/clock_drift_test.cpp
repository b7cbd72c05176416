// Agents whose clocks run too fast or too slow, as much as docs/safety.md allows.
#include <algorithm>

#include <gtest/gtest.h>

#include "coppice/files/scenario_file.h"
#include "messages/clock_offset.h"
#include "simulation/fault_schedule.h"
#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/support.h"

namespace coppice {
namespace {

TEST(ClockDrift, AClockTellsTheTrueTimeOfItsLocalTime) {
  const AgentClock clock{.offset = -3, .drift = 1e-4};
  EXPECT_DOUBLE_EQ(clock.local(1000), 997.1);
  EXPECT_DOUBLE_EQ(clock.true_time(997.1), 1000);
  EXPECT_DOUBLE_EQ(clock.counted_from(400).local(600), 597.1);
}

TEST(ClockDrift, DriftChangesNoOtherFault) {
  const Scenario scenario = read_scenario(test::scenarios() / "rooms-8.json", {});
  const Faults faults{.pause_rate = 100, .clock_skew = 1};
  Faults drifting = faults;
  drifting.clock_drift = clock_drift;
  const std::vector<AgentFaults> drawn = draw_faults(drifting, scenario, 1000);
  const std::vector<AgentFaults> without = draw_faults(faults, scenario, 1000);
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    EXPECT_EQ(drawn[k].pauses, without[k].pauses);
    EXPECT_EQ(drawn[k].clock.offset, without[k].clock.offset);
    EXPECT_EQ(without[k].clock.drift, 0);
    EXPECT_LE(std::abs(drawn[k].clock.drift), clock_drift / 2);
  }
}

TEST(ClockDrift, ClocksRunApartAndNothingTouches) {
  const Scenario scenario = read_scenario(test::scenarios() / "rooms-8.json", {});
  const SimulationSettings settings{.lifelong = 300, .faults = {.clock_skew = 1, .clock_drift = clock_drift}};
  const std::vector<AgentFaults> drawn = draw_faults(settings.faults, scenario, settings.timeout);
  FleetSimulation simulation(scenario, settings);
  simulation.run([](const PlannerService&, double) { return true; });
  EXPECT_EQ(simulation.service().report(in_parts(simulation.tracks())).outcome(), "arrived");
  const auto broken = broken_invariants(scenario, simulation);
  EXPECT_TRUE(broken.empty()) << broken.front();
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    const std::vector<TrackPoint>& points = simulation.tracks()[k].track.points;
    const double periods = static_cast<double>(points.size() - 1);
    const double local = periods * control_period;
    EXPECT_NEAR(points.back().time - points.front().time, local / (1 + drawn[k].clock.drift), 1e-6);
    EXPECT_GT(local, 300);
  }
  const auto [slowest, fastest] =
      std::ranges::minmax(drawn, {}, [](const AgentFaults& agent) { return agent.clock.drift; });
  EXPECT_GT(fastest.clock.drift - slowest.clock.drift, clock_drift / 4);
}

}  // namespace
}  // namespace coppice
