// tree_broker --domain D: grows the shared trees of a fleet until it is told to stop.

#include <random>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "bus/dds_bus.h"
#include "bus/process.h"
#include "tree_broker/tree_broker.h"

int main(int argc, char** argv) {
  using namespace coppice;
  int domain = 0;
  std::uint64_t seed = 1;
  std::string discovery;
  std::string security;
  std::string level = "info";
  CLI::App app{"Coppice tree broker: grows the disjointed trees that every robot may use"};
  app.set_version_flag("--version", COPPICE_VERSION);
  app.add_option("--domain", domain, "DDS domain")->check(CLI::Range(0, 232));
  app.add_option("--discovery", discovery,
                 "multicast, static, or discovery servers: HOST:PORT, several with ; between them");
  app.add_option("--security", security, "folder with this role's credentials");
  app.add_option("--seed", seed, "of every random choice");
  app.add_option("--log-level", level, "trace, debug, info, warning, error or off");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  if (!set_up_logging("tree_broker", level)) {
    std::cerr << "--log-level: unknown level " << level << '\n';
    return 2;
  }
  install_stop_signals();
  try {
    // Every start of a broker is another broker: its trees are its own.
    std::random_device device;
    const std::uint64_t id = (static_cast<std::uint64_t>(device()) << 32) | device();
    DdsBus bus({.domain = domain, .discovery = discovery, .security = security}, Role::broker, "tree_broker");
    TreeBroker broker(id, seed);
    spdlog::info("broker {:016x} on domain {}", id, domain);
    while (!stop_requested()) run_role_once(bus, broker);
  } catch (const std::exception& problem) {
    spdlog::error("{}", problem.what());
    return 2;
  }
  return 0;
}
