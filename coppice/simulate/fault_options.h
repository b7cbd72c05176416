// The options for simulated faults.
#pragma once

#include <optional>

#include "coppice/simulation/faults.h"

namespace CLI {
class App;
}  // namespace CLI

namespace coppice {

/// Adds the options to a command. Values out of range are usage errors. `tracking_tolerance`: of robots that
/// follow badly.
void add_fault_options(CLI::App& command, Faults& faults, std::optional<double>& tracking_tolerance);

}  // namespace coppice
