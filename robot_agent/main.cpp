// robot_agent --name NAME --domain D: one robot, until it is told to stop.

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "bus/dds_bus.h"
#include "bus/process.h"
#include "bus/validation.h"
#include "robot_agent/robot_agent.h"

int main(int argc, char** argv) {
  using namespace coppice;
  int domain = 0;
  std::string name;
  std::string discovery;
  std::string security;
  std::string level = "info";
  CLI::App app{"Coppice robot agent: plans, drives and avoids for one robot"};
  app.set_version_flag("--version", COPPICE_VERSION);
  app.add_option("--name", name, "of the robot, as the scenario names it")->required();
  app.add_option("--domain", domain, "DDS domain")->check(CLI::Range(0, 232));
  app.add_option("--discovery", discovery,
                 "multicast, static, or discovery servers: HOST:PORT, several with ; between them");
  app.add_option("--security", security, "folder with this role's credentials");
  app.add_option("--log-level", level, "trace, debug, info, warning, error or off");
  try {
    app.parse(argc, argv);
    if (name.empty() || name.size() > longest_name) {
      throw CLI::ValidationError("--name", fmt::format("expected 1 to {} characters", longest_name));
    }
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  if (!set_up_logging("robot_agent " + name, level)) {
    std::cerr << "--log-level: unknown level " << level << '\n';
    return 2;
  }
  install_stop_signals();
  try {
    DdsBus bus({.domain = domain, .robot = name, .discovery = discovery, .security = security}, Role::agent,
               "robot_agent " + name);
    RobotAgent agent(name);
    spdlog::info("on domain {}", domain);
    while (!stop_requested()) run_role_once(bus, agent);
  } catch (const std::exception& problem) {
    spdlog::error("{}", problem.what());
    return 2;
  }
  return 0;
}
