// The process of an agent that asks the planner service which robot it is (claimant.h).
#pragma once

#include "robot_agent/options.h"
#include "runtime/process.h"

namespace coppice {

/// Runs until the process is told to stop. Returns the exit code: 1 if another agent is that robot by now.
int run_unnamed(const AgentOptions& options, Heartbeat& heart);

}  // namespace coppice
