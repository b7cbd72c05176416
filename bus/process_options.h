// The options that all processes of a fleet have.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "bus/dds_bus.h"

namespace coppice {

struct ProcessOptions {
  DdsSettings network;
  std::string state;  ///< folder for what it keeps for its successor; empty: nothing is kept
  std::string alive;  ///< file that is touched every second; empty: none
  std::string log_level = "info";
  bool log_json = false;
};

/// Of an option that says how processes find each other (DdsSettings::discovery).
CLI::Validator a_discovery();

/// Values out of range are usage errors.
void add_process_options(CLI::App& app, ProcessOptions& options);

}  // namespace coppice
