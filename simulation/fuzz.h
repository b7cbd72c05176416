// Random tests of a fleet: a scenario and faults, both drawn from a seed, and the conditions that must hold
// at the end.
//
// A case fails if an invariant is broken (invariants.h), or if a robot is stuck. A robot is stuck if it was
// not killed, has not arrived, has a way past the failed robots and, if a robot failed, a joint plan from the
// final positions would bring it to its goal.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/files/scenario.h"
#include "simulation/fault_schedule.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

struct FuzzCase {
  std::uint32_t seed = 0;
  std::string what;  ///< scenario and faults in words
  Scenario scenario;
  SimulationSettings settings;
};

/// The same seed gives the same case. `restarts`: agents are also killed and restarted. `turning`: all robots
/// are differential.
FuzzCase draw_fuzz_case(std::uint32_t seed, bool restarts = false, bool turning = false);

struct FuzzResult {
  std::vector<std::string> failures;  ///< empty: the case is passed
  /// Robots that did not arrive, but for which no joint plan past the failed robots was found, or for which
  /// no process knew where those are.
  std::vector<std::string> shut_in;
  double robot_hours = 0;
  SufferedFaults suffered;
};

/// `simulation` must have run the case to its end.
FuzzResult judge(const FuzzCase& fuzz_case, const FleetSimulation& simulation);

}  // namespace coppice
