// The halts of a fuzz case: an operator pauses or stops robots, and lets them go on.
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/fuzz.h"

namespace coppice {

/// In the order of their times. Each halt ends. `driving`: as for the faults (fuzz_faults.h).
std::vector<TimedOrder> draw_halts(const Scenario& scenario, double driving, std::uint32_t seed);

}  // namespace coppice
