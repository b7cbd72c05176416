// The subcommands that show a fleet or a recording.
#pragma once

#include <string>

#include "coppice/commands.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace coppice {

struct WatchingOptions {
  MonitorOptions monitor;
  TopOptions top;
  RecordOptions record;
  std::string recording;  ///< for info
  ExplainOptions explain;
  ReplayOptions replay;
  PictureOptions picture;
};

/// Adds --domain, --discovery and --security. `role`: whose credentials; `domain`: the default, as text for
/// the help.
void add_network_options(CLI::App& command, DdsSettings& network, const std::string& role,
                         const std::string& domain);
inline constexpr const char* domain_of_fleet = "that of the fleet that is alive on this machine, or 0";
/// If no domain was named, chooses the fleet that is alive on this machine.
void find_fleet(const CLI::App& command, DdsSettings& network);

/// Adds --record, which it returns, and --force.
CLI::Option* add_recording_options(CLI::App& command, NewRecording& record, const char* of_what);

/// Parsing fills in `options` and `chosen`, which must outlive it.
void add_watching_commands(CLI::App& app, WatchingOptions& options, ChosenCommand& chosen);

}  // namespace coppice
