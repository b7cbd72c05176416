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

/// `options` and `chosen` outlive the parsing, which fills them in.
void add_watching_commands(CLI::App& app, WatchingOptions& options, ChosenCommand& chosen);

}  // namespace coppice
