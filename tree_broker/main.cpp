// tree_broker --domain D: grows the shared trees of a fleet until it is stopped.

#include <random>
#include <utility>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "dds/dds_bus.h"
#include "messages/keep.h"
#include "runtime/command_line.h"
#include "runtime/journal.h"
#include "runtime/process.h"
#include "tree_broker/forest_record.h"
#include "tree_broker/options.h"
#include "tree_broker/tree_broker.h"

namespace {

using namespace coppice;

int run(const ProcessOptions& options, std::uint64_t seed) {
  ProcessClock clock(options.state);
  auto journal = journal_in(options.state, "tree_broker");
  if (journal && !journal->complete()) {
    spdlog::warn("{}: the disk was full when it was written: some trees may be missing",
                 journal->file().string());
    journal->accept_gaps();
  }
  ForestRecord record;
  if (journal) record.recall(journal->messages());
  Keeper keeper(std::move(record), journal ? &*journal : nullptr);
  // Each start gets a new id, because each start of a broker names its own trees.
  std::random_device device;
  const std::uint64_t id = (static_cast<std::uint64_t>(device()) << 32) | device() | 1u;
  DdsBus bus(options.network, Role::broker, "tree_broker");
  Heartbeat heart(options.alive);
  TreeBroker broker(id, seed);
  if (journal) broker.recall(journal->messages(), clock.now());
  spdlog::info("broker {:016x} on domain {}", id, options.network.domain);
  bool led = false;
  while (!stop_requested()) {
    run_role_once(bus, broker, keeper, clock);
    if (journal && !journal->complete()) journal->accept_gaps();  // the disk may have room again
    heart.beat(clock.now());
    if (broker.leads() != std::exchange(led, broker.leads()))
      spdlog::info("{}", led ? "leads" : "stands by: another broker leads");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  fill_standard_streams();
  CLI::App app;
  BrokerOptions options;
  add_broker_options(app, options);
  if (const auto exit_code = parse(app, argc, argv)) return *exit_code;
  set_up_logging("tree_broker", options.process.log.level, options.process.log.json);
  install_stop_signals();
  return exit_code_of([&] { return run(options.process, options.seed); });
}
