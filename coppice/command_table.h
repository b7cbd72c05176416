// Every command of `coppice` with its options, and the options of all other programs: for parsing, and for
// all that is made of them (help, manual pages, completion, tests).
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "coppice/commands.h"
#include "coppice/watching_options.h"

namespace coppice {

/// What the command line says.
struct CommandOptions {
  RunOptions run;  ///< of run, simulate and plan
  FleetOptions fleet;
  WatchingOptions watching;
  DiscoveryOptions discovery;
  FleetPlan fleet_plan;
  Faults faults;
  NewRecording record;  ///< of simulate
  FuzzOptions fuzz;
  MapOptions map;
  BenchOptions bench;
  std::string help_topic;  ///< empty: all commands
};

/// Adds all commands. Parsing fills in `options` and `chosen`, which outlive it; it runs nothing.
void add_commands(CLI::App& app, CommandOptions& options, ChosenCommand& chosen);

/// Shows the command line of each program that is installed, one after the other. An app has its program's
/// name, and its commands as subcommands.
void visit_programs(const std::function<void(const CLI::App&)>& visit);

}  // namespace coppice
