// Invariants of every run, whatever faults occurred: those of the recorded tracks, and the lemmas that a
// sentinel checks at each decision (sentinel.h).
#pragma once

#include <string>
#include <vector>

#include "coppice/files/scenario.h"
#include "files/trajectory_file.h"
#include "simulation/fleet_simulation.h"

namespace coppice {

/// Returns a line for each broken invariant; empty if all hold. Robots begin at their starts, keep clear of
/// each other and of obstacles (in continuous time; a robot that begins too near to an obstacle drives out
/// first), keep their limits of speed and acceleration, and never jump. `period`: seconds between two points
/// of a track.
std::vector<std::string> broken_invariants(const Scenario& scenario, const std::vector<NamedTrack>& tracks,
                                           double period);
/// The same of a run. First comes the lemma that a decision broke, which ended the run.
std::vector<std::string> broken_invariants(const Scenario& scenario, const FleetSimulation& simulation);

}  // namespace coppice
