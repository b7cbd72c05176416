// When all robots of a simulated run have arrived, at the latest (docs/coordination.md, "What bounds the time
// to arrive").
//
// Seconds of fleet time.
#pragma once

#include "simulation/fleet_simulation.h"
#include "simulation/fuzz.h"

namespace coppice {

/// After what `simulation` has run of the case.
double arrival_bound(const FuzzCase& fuzz_case, const FleetSimulation& simulation);

}  // namespace coppice
