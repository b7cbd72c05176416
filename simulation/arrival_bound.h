// When all robots of a simulated run have arrived, at the latest (docs/coordination.md, "What bounds the time
// to arrive").
//
// Seconds of fleet time.
#pragma once

#include "report.pb.h"
#include "simulation/fuzz.h"

namespace coppice {

/// `report`: of the run. `suffered`: the faults that have occurred in it.
double arrival_bound(const FuzzCase& fuzz_case, const SufferedFaults& suffered, const proto::Report& report);

}  // namespace coppice
