// The faults of a fuzz case. They are within the assumptions of docs/safety.md: what exceeds these need not
// be survived.
//
// Seconds of virtual time.
#pragma once

#include <cstdint>

#include "coppice/files/scenario.h"
#include "coppice/planning/random.h"
#include "coppice/simulation/faults.h"

namespace coppice {

/// `driving`: seconds from the beginning in which robots are likely to drive. Most faults strike then.
/// `restarts`: agents are also killed and restarted.
Faults draw_faults_of_case(const Scenario& scenario, double driving, bool restarts, std::uint32_t seed);

/// How badly the robots of a case follow, if they have tracking tolerances: no worse than these allow.
DriveFaults draw_drive_faults(const Scenario& scenario, Random& random);

}  // namespace coppice
