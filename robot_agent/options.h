// The command line of robot_agent.
#pragma once

#include <string>

#include "runtime/process_options.h"

namespace coppice {

struct AgentOptions {
  ProcessOptions process;
  RosOptions ros;
  std::string black_boxes;  ///< folder (runtime/black_box.h); empty: none
  std::string name;         ///< empty: the service says which robot it is
};

/// `options` outlives the parsing.
void add_agent_options(CLI::App& app, AgentOptions& options);

}  // namespace coppice
