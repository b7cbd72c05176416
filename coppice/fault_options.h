// The options of simulated faults.
#pragma once

#include <CLI/CLI.hpp>

#include "simulation/faults.h"

namespace coppice {

/// Adds the options to a command; values out of range are usage errors.
void add_fault_options(CLI::App& command, Faults& faults);

}  // namespace coppice
