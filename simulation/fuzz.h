// Random tests of a fleet: a scenario, faults and halts, all drawn from a seed. What is drawn is admitted: a
// fleet must bear it (docs/safety.md).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "coppice/files/scenario.h"
#include "messages/messages.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

/// An order that an operator gives in a run.
struct TimedOrder {
  double time = 0;  ///< virtual seconds
  OrderMessage order;
};

struct FuzzCase {
  std::uint32_t seed = 0;
  std::string what;  ///< all that was drawn, in words
  Scenario scenario;
  SimulationSettings settings;
  std::vector<TimedOrder> halts{};  ///< pauses and stops, and the ends of them, in the order of their times
};

/// The same seed gives the same case. `restarts`: agents are also killed and restarted.
FuzzCase draw_fuzz_case(std::uint32_t seed, bool restarts = false);

/// Runs a simulation of the case to its end, and gives the orders. `watch`: as of FleetSimulation::run.
void run_fuzz_case(const FuzzCase& fuzz_case, FleetSimulation& simulation,
                   const std::function<bool(const PlannerService&, double)>& watch);

}  // namespace coppice
