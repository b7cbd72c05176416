// When all robots of a simulated run have arrived, at the latest (docs/coordination.md, "What bounds the time
// to arrive").
//
// Seconds of fleet time.
#pragma once

#include "report.pb.h"
#include "simulation/fuzz.h"

namespace coppice {

/// The sum of the times that the robots would need alone for their last ways.
double free_flow_of(const proto::Report& report);

/// `suffered`: the faults that have occurred in the run. `free_flow`: as above.
double arrival_bound(const FuzzCase& fuzz_case, const SufferedFaults& suffered, double free_flow);

}  // namespace coppice
