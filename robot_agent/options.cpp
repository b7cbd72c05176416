#include "robot_agent/options.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "planning/robot_name.h"
#include "runtime/command_line.h"

namespace coppice {

namespace {

CLI::Validator a_robot_name() {
  return {[](const std::string& text) {
            return is_robot_name(text) ? std::string() : fmt::format("expected {}", robot_name_rule);
          },
          "NAME"};
}

}  // namespace

void add_agent_options(CLI::App& app, AgentOptions& options) {
  set_up_command_line(app, "robot_agent", "Coppice robot agent: plans, drives and avoids for one robot");
  app.add_option("--name", options.name, "of the robot, as the scenario names it")
      ->check(a_robot_name())
      ->default_str("one that the service says");
  add_process_options(app, options.process);
  add_black_box_option(app, options.black_boxes,
                       "folder for the end of the robot's track, should this process be killed");
  add_ros_options(app, options.ros, true, false);
}

}  // namespace coppice
