// The options for simulated faults.
#pragma once

#include "coppice/simulation/faults.h"

namespace CLI {
class App;
}  // namespace CLI

namespace coppice {

/// Adds the options to a command. Values out of range are usage errors.
void add_fault_options(CLI::App& command, Faults& faults);

}  // namespace coppice
