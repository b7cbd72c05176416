// The corners of a way, for a robot that stays close to the way. At the inside of a corner the nearest point
// of the way jumps: so the robot comes further along the way than it drives.
//
// Metres in the map frame.
#pragma once

#include <span>
#include <vector>

#include "coppice/planning/geometry.h"

namespace coppice {

struct Corner {
  double at = 0;    ///< metres along the way
  double jump = 0;  ///< metres along the way, at most
};

/// The corners of a way at which a robot that strays by `stray` metres at most may gain more than rounding.
/// Corners of a right angle or more are none of them: a robot comes to a stop there (legs_of()).
std::vector<Corner> corners_of(const Path& way, double stray);

/// Metres by which the robot may come further along the way than it drives, between two places on it.
double gained_at(std::span<const Corner> corners, double from, double to);

}  // namespace coppice
