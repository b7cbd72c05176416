#include "tree_broker/options.h"

#include <limits>

#include <CLI/CLI.hpp>

#include "files/number_check.h"
#include "runtime/command_line.h"

namespace coppice {

void add_broker_options(CLI::App& app, BrokerOptions& options) {
  set_up_command_line(app, "tree_broker",
                      "Coppice tree broker: grows the disjointed trees that every robot may use");
  add_process_options(app, options.process);
  app.option_defaults()->group("Planning");
  app.add_option("--seed", options.seed, "seed of all random choices")
      ->check(whole_number_between<std::uint64_t>(0, std::numeric_limits<std::uint64_t>::max()));
}

}  // namespace coppice
