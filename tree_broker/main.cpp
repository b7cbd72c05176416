// tree_broker --domain D: grows the shared trees of a fleet until it is told to stop.

#include <random>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "bus/dds_bus.h"
#include "bus/journal.h"
#include "bus/keep.h"
#include "bus/process.h"
#include "tree_broker/forest_record.h"
#include "tree_broker/tree_broker.h"

int main(int argc, char** argv) {
  using namespace coppice;
  int domain = 0;
  std::uint64_t seed = 1;
  std::string discovery;
  std::string state;
  int datagram = datagram_for_networks;
  std::string level = "info";
  CLI::App app{"Coppice tree broker: grows the disjointed trees that every robot may use"};
  app.set_version_flag("--version", COPPICE_VERSION);
  app.add_option("--domain", domain, "DDS domain")->check(CLI::Range(0, 232));
  app.add_option("--discovery", discovery,
                 "multicast, static, or discovery servers: HOST:PORT, several with ; between them");
  app.add_option("--datagram", datagram, "largest UDP datagram, bytes: the default fits every network")
      ->check(CLI::Range(datagram_for_networks, datagram_for_one_host));
  app.add_option("--seed", seed, "of every random choice");
  app.add_option("--state", state, "folder in which it keeps the forest, for when it is started anew");
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
    auto journal = journal_in(state, "tree_broker");
    const std::vector<Message> kept = journal ? journal->take_recalled() : std::vector<Message>();
    ForestRecord record;
    record.recall(kept);
    Keeper keeper(std::move(record), journal ? &*journal : nullptr);
    DdsBus bus({.domain = domain, .discovery = discovery, .largest_datagram = datagram}, Role::broker,
               "tree_broker");
    TreeBroker broker(id, seed);
    broker.recall(kept, wall_now());
    spdlog::info("broker {:016x} on domain {}", id, domain);
    bool led = false;
    while (!stop_requested()) {
      run_role_once(bus, broker, keeper);
      if (broker.leads() != std::exchange(led, broker.leads()))
        spdlog::info("{}", led ? "leads" : "stands by: another broker leads");
    }
  } catch (const std::exception& problem) {
    spdlog::error("{}", problem.what());
    return 2;
  }
  return 0;
}
