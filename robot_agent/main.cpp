// robot_agent [--name NAME] --domain D: one robot, until it is told to stop.

#include <string>

#include <CLI/CLI.hpp>

#include "robot_agent/options.h"
#include "robot_agent/process/run_named.h"
#include "robot_agent/process/run_unnamed.h"
#include "runtime/command_line.h"
#include "runtime/process.h"

int main(int argc, char** argv) {
  using namespace coppice;
  fill_standard_streams();
  CLI::App app;
  AgentOptions options;
  add_agent_options(app, options);
  if (const auto exit_code = parse(app, argc, argv)) return *exit_code;
  const std::string& name = options.name;
  set_up_logging(name.empty() ? "robot_agent" : "robot_agent " + name, options.process.log.level,
                 options.process.log.json);
  install_stop_signals();
  return exit_code_of([&] {
    check_ros(options.ros, options.process.network.discovery, options.process.network.security);
    Heartbeat heart(options.process.alive);
    return name.empty() ? run_unnamed(options, heart) : run_named(options, heart);
  });
}
