// Every command of `coppice` with its options, and the options of all other programs. Used for parsing, and
// for everything made from the options (help, manual pages, completion, tests).
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "coppice/commands.h"
#include "coppice/orders/order_options.h"
#include "coppice/run/watching_options.h"

namespace coppice {

/// The values of the command line.
struct CommandOptions {
  RunOptions run;  ///< for run, simulate and plan
  FleetOptions fleet;
  WatchingOptions watching;
  OrderOptions order;
  StateOptions state;
  InspectOptions inspect;
  DiscoveryOptions discovery;
  FleetPlan fleet_plan;
  Faults faults;
  NewRecording record;  ///< for simulate
  FuzzOptions fuzz;
  GridPlanOptions grid_plan{};
  MapOptions map;
  BenchOptions bench;
  std::string help_topic;  ///< empty: all commands
};

/// Adds all commands. Parsing fills in `options` and `chosen`, which must outlive it, and runs no command.
void add_commands(CLI::App& app, CommandOptions& options, ChosenCommand& chosen);

/// Calls `visit` with the command line of each installed program. An app has its program's name, and the
/// program's commands as subcommands.
void visit_programs(const std::function<void(const CLI::App&)>& visit);

}  // namespace coppice
