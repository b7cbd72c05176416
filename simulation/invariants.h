// What must hold in every run, whatever went wrong in it: checked on the record alone.
#pragma once

#include <string>
#include <vector>

#include "files/scenario.h"
#include "files/trajectory_file.h"

namespace coppice {

/// Each thing that does not hold, a line each; empty: all is well. Robots begin at their starts, keep clear
/// of each other and of every obstacle (in continuous time), keep their limits on speed and acceleration, and
/// never jump. `period`: seconds between two points of a track.
std::vector<std::string> broken_invariants(const Scenario& scenario, const std::vector<NamedTrack>& tracks,
                                           double period);

}  // namespace coppice
