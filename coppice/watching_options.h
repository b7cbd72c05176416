// The subcommands that look at a fleet, or at a recording of one.
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
  std::string recording;  ///< of info
  ReplayOptions replay;
  PictureOptions picture;
};

/// --record, which it returns, and --force.
CLI::Option* add_recording_options(CLI::App& command, NewRecording& record, const char* of_what);

/// `options` and `exit_code` outlive the parsing; that runs the command.
void add_watching_commands(CLI::App& app, WatchingOptions& options, int& exit_code);

}  // namespace coppice
