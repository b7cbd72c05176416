#include "planner_service/options.h"

#include <CLI/CLI.hpp>

#include "runtime/command_line.h"

namespace coppice {

void add_service_options(CLI::App& app, ServiceOptions& options) {
  set_up_command_line(app, "planner_service",
                      "Coppice planner service: missions in, progress and a report out");
  add_run_options(app, options.run, Progression::one_process);
  app.add_flag("--serve", options.run.serves,
               "continues when all robots have arrived, and waits for orders until it is stopped; robots of "
               "the scenario need no goals")
      ->excludes("--timeout");
  app.add_option("--start-at", options.start_at,
                 "file of poses where the robots stand as a new run begins (docs/reference.md)")
      ->type_name("POSES")
      ->needs("--serve")
      ->default_str("where they stood at last, or in a new fleet the scenario's starts");
  add_process_options(app, options.process);
  add_black_box_option(
      app, options.black_boxes,
      "folder of agents on this host, where those that were killed left the ends of their tracks");
  add_ros_options(app, options.ros, false, true);
}

}  // namespace coppice
