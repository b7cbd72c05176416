// The speed at which a robot drives around a corner of its way without straying far.
//
// Metres in the map frame, metres per second.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/kinematics.h"
#include "planning/geometry.h"

namespace coppice {

/// Share of the acceleration for braking before corners; the rest is for turning.
inline constexpr double braking_share = 0.5;

/// The radius of the arc that touches both edges of a corner and strays from it by `stray`. `in` and `out`:
/// the directions of the edges, of length 1. Infinite where there is no turn.
inline double arc_radius(const Point2& in, const Point2& out, double stray) {
  const double cosine = std::sqrt(std::max(0.0, (1 + in.dot(out)) / 2));  // of half of the turn
  if (cosine < 1e-6) return 0;
  const double share = 1 / cosine - 1;
  return share < 1e-9 ? std::numeric_limits<double>::infinity() : stray / share;
}

inline double speed_around(const Point2& in, const Point2& out, double stray, double acceleration) {
  return std::sqrt(acceleration * braking_share * arc_radius(in, out, stray));
}

/// Seconds that a robot at full speed loses because it slows down for a corner.
inline double time_lost_around(const Point2& in, const Point2& out, double stray, const Limits& limits) {
  const double full = limits.max_speed;
  const double change = full - std::min(full, speed_around(in, out, stray, limits.max_acceleration));
  return change * change * (1 + 1 / braking_share) / (2 * limits.max_acceleration * full);
}

}  // namespace coppice
