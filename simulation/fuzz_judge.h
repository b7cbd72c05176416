// Judges the run of a fuzz case.
//
// A case fails if an invariant or a lemma is broken (invariants.h), if a robot arrives later than the bound
// (arrival_bound.h), or if a robot is stuck. A robot is stuck if it was not killed, has not arrived, has a
// way past all places where, as far as it knows, failed robots may stand and, if a robot failed, a joint plan
// from the final positions would bring it to its goal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "simulation/fleet_simulation.h"
#include "simulation/fuzz.h"

namespace coppice {

struct FuzzResult {
  std::vector<std::string> failures;  ///< empty: the case is passed
  /// Robots that did not arrive, but for which no joint plan past the failed robots was found, or for which
  /// no process knew where those are.
  std::vector<std::string> shut_in;
  double robot_hours = 0;
  std::size_t decisions = 0;  ///< that the sentinel checked
  SufferedFaults suffered;
};

/// `simulation` must have run the case to its end.
FuzzResult judge(const FuzzCase& fuzz_case, const FleetSimulation& simulation);

}  // namespace coppice
