// The processes of a run on this machine: their programs, and the options that each gets.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "coppice/commands.h"
#include "coppice/files/scenario.h"
#include "coppice/run/process_fleet.h"
#include "dds/dds_bus.h"

namespace coppice {

inline constexpr const char* service_name = "planner_service";
inline constexpr const char* recorder_name = "recorder";

/// With which this process, which only observes, finds the others.
DdsSettings settings_of(const FleetOptions& options, std::size_t robots);

/// The command that shows the fleet in another terminal.
std::string watching_command(const FleetOptions& options, std::size_t robots);

struct Process {
  std::string name;
  std::vector<std::string> command;  ///< program and arguments
  ProcessFleet::Output output = ProcessFleet::Output::log;
  int niceness = 0;
};

/// In the order in which they start. `programs`: folder of the roles' programs. `state`: folder for their
/// state; empty: none. `black_boxes`: folder for the ends of tracks. Throws InputError if credentials are
/// invalid.
std::vector<Process> processes_of(const Scenario& scenario, const RunOptions& options,
                                  const FleetOptions& fleet, const std::filesystem::path& programs,
                                  const std::filesystem::path& state,
                                  const std::filesystem::path& black_boxes);

}  // namespace coppice
