// robot_agent --name NAME --domain D: one robot, until it is told to stop.

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "bus/dds_bus.h"
#include "bus/journal.h"
#include "bus/keep.h"
#include "bus/process.h"
#include "bus/validation.h"
#include "robot_agent/memory.h"
#include "robot_agent/robot_agent.h"

int main(int argc, char** argv) {
  using namespace coppice;
  int domain = 0;
  std::string name;
  std::string discovery;
  std::string state;
  int datagram = datagram_for_networks;
  std::string level = "info";
  CLI::App app{"Coppice robot agent: plans, drives and avoids for one robot"};
  app.set_version_flag("--version", COPPICE_VERSION);
  app.add_option("--name", name, "of the robot, as the scenario names it")->required();
  app.add_option("--domain", domain, "DDS domain")->check(CLI::Range(0, 232));
  app.add_option("--discovery", discovery,
                 "multicast, static, or discovery servers: HOST:PORT, several with ; between them");
  app.add_option("--state", state,
                 "folder in which it keeps where its robot is, for when it is started anew");
  app.add_option("--datagram", datagram, "largest UDP datagram, bytes: the default fits every network")
      ->check(CLI::Range(datagram_for_networks, datagram_for_one_host));
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
    auto journal = journal_in(state, name);
    if (journal && !journal->complete()) {
      throw std::runtime_error(
          journal->file().string() +
          ": the disk was full when it was written, so that it does not say where the robot is: remove "
          "it once the robot stands at the start of its mission");
    }
    const std::vector<Message> kept = journal ? journal->take_recalled() : std::vector<Message>();
    Remembrance remembrance(name);
    remembrance.recall(kept);
    Keeper keeper(std::move(remembrance), journal ? &*journal : nullptr);
    DdsBus bus({.domain = domain, .robot = name, .discovery = discovery, .largest_datagram = datagram},
               Role::agent, "robot_agent " + name);
    RobotAgent agent(name);
    agent.recall(kept);
    spdlog::info("on domain {}", domain);
    while (!stop_requested()) run_role_once(bus, agent, keeper);
  } catch (const std::exception& problem) {
    spdlog::error("{}", problem.what());
    return 2;
  }
  return 0;
}
