// Checks the input of a simulated run.
#pragma once

#include "coppice/files/scenario.h"
#include "coppice/simulation/simulate.h"

namespace coppice {

/// Throws InputError, which names the field and what was expected, if the scenario or the settings make no
/// sense.
void check_simulation(const Scenario& scenario, const SimulationSettings& settings);

}  // namespace coppice
