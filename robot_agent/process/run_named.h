// The process of an agent that was told which robot it is.
#pragma once

#include "robot_agent/options.h"
#include "runtime/process.h"

namespace coppice {

/// Runs until the process is told to stop. Returns the exit code.
int run_named(const AgentOptions& options, Heartbeat& heart);

}  // namespace coppice
