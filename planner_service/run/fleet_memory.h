// What a standing fleet keeps from one of its runs to the next, in the folder of the service's state: the
// halts, which orders have ended, and where its robots stand. The journal of a run (saved_run.h) ends with
// the run.
//
// The files are text that does not depend on the version: `fleet.json` (idl/fleet_memory.proto), and
// `poses.json` (files/pose_file.h).
#pragma once

#include <filesystem>
#include <vector>

#include "coppice/files/scenario.h"
#include "files/pose_file.h"
#include "messages/messages.h"

namespace coppice {

struct FleetMemory {
  HaltMessage halts{};
  std::vector<OrderStatus> orders{};  ///< in the order of their ends
  std::vector<RobotPose> poses{};     ///< empty: the fleet is new
};

/// What a fleet before this one left in the folder. Throws InputError, which names the file, if it cannot be
/// read.
FleetMemory remembered_in(const std::filesystem::path& folder);

/// Replaces what was kept there. Each file is replaced at once: a process that is killed meanwhile leaves the
/// old one. Throws InputError, which names the file, if it cannot be written.
void remember(const std::filesystem::path& folder, const FleetMemory& memory, const Scenario& site);

}  // namespace coppice
