// The command line of planner_service.
#pragma once

#include "files/run_options.h"
#include "runtime/process_options.h"

namespace coppice {

struct ServiceOptions {
  RunOptions run;
  ProcessOptions process;
  std::string start_at;     ///< file of poses where the robots of a standing fleet begin; empty: none
  std::string black_boxes;  ///< folder (runtime/black_box.h); empty: none
  RosOptions ros;
};

/// `options` must outlive the parsing.
void add_service_options(CLI::App& app, ServiceOptions& options);

}  // namespace coppice
