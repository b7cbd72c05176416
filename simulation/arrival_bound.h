// When all robots of a simulated run have arrived, at the latest (docs/coordination.md, "What bounds the time
// to arrive").
//
// Seconds of fleet time.
#pragma once

#include "simulation/fuzz.h"

namespace coppice {

/// `suffered`: the faults that have occurred in the run. `free_flow`: the sum of the times that the robots
/// would need alone for their last ways.
double arrival_bound(const FuzzCase& fuzz_case, const SufferedFaults& suffered, double free_flow);

}  // namespace coppice
