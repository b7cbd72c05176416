// The earliest times at which a robot may drive along a given path, past the trajectories of others.
//
// Safe intervals, as in safe_interval_search.h, on a path instead of a graph.
//
// Metres in the map frame, seconds of fleet time.
#pragma once

#include <optional>

#include "coppice/motion/kinematics.h"
#include "coppice/motion/trajectory.h"
#include "motion/trajectory/space_time.h"

namespace coppice {

/// The trajectory along the path with the earliest arrival. It begins at `begin` and is at rest or at full
/// speed; it stands where it slows down for a corner, for as long as it loses there, and so after each wait.
/// `stray`: metres by which the robot may stray from the path. Nothing if it cannot stay at the end for
/// `stays` seconds.
std::optional<Trajectory> earliest_along(const Path& path, SpaceTime& others, double begin, double stray,
                                         const Limits& limits, double stays = SpaceTime::forever);

}  // namespace coppice
