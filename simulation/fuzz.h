// Cases for a fleet to survive: a scenario and faults, both drawn from a seed, and what must hold in the end.
//
// A case fails if an invariant is broken (invariants.h), or if a robot is stuck: it is not killed, has not
// arrived, no failed robot closes its way, and, if somebody died, a joint plan from where they all are in the
// end would bring it to its goal.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "files/scenario.h"
#include "simulation/faults.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

struct FuzzCase {
  std::uint32_t seed = 0;
  std::string what;  ///< scenario and faults in words
  Scenario scenario;
  SimulationSettings settings;
};

/// The same seed gives the same case. `restarts`: and agents are killed and started anew.
FuzzCase draw_fuzz_case(std::uint32_t seed, bool restarts = false);

struct FuzzResult {
  std::vector<std::string> failures;  ///< empty: survived
  /// Stuck, but no joint plan was found that brings it past the failed, or nobody knows where these are.
  std::vector<std::string> shut_in;
  double robot_hours = 0;
  SufferedFaults suffered;
};

/// `simulation` has run the case to its end.
FuzzResult judge(const FuzzCase& fuzz_case, const FleetSimulation& simulation);

}  // namespace coppice
