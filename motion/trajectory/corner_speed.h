// The speed at which a robot drives around a corner of its way without straying far.
//
// Metres in the map frame, metres per second.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "coppice/motion/kinematics.h"
#include "coppice/planning/geometry.h"

namespace coppice {

/// The radius of the arc that touches both edges of a corner and strays from it by `stray`. `in` and `out`:
/// the directions of the edges, of length 1. Infinite where there is no turn.
inline double arc_radius(const Point2& in, const Point2& out, double stray) {
  const double cosine = std::sqrt(std::max(0.0, (1 + in.dot(out)) / 2));  // of half of the turn
  if (cosine < 1e-6) return 0;
  const double share = 1 / cosine - 1;
  return share < 1e-9 ? std::numeric_limits<double>::infinity() : stray / share;
}

/// The speed on an arc. The robot must be able to turn so fast. And if it brakes at any point of the arc, on
/// a straight line, it must not stray by more than `stray`. `period`: of control; braking begins half a
/// period late on average. 0 gives an upper bound.
inline double speed_on_arc(double radius, double stray, const Limits& limits, double period) {
  const double turning = is_differential(limits) ? std::min(std::sqrt(sideways_acceleration(limits) * radius),
                                                            limits.max_angular_speed * radius)
                                                 : std::sqrt(limits.max_acceleration * radius);
  const double braking = speed_to_stop_within(std::sqrt(2 * stray * radius), limits, period / 2);
  return std::min({turning, braking, limits.max_speed});
}

/// Seconds that a robot at full speed loses because it slows down for a corner: before and after the arc, and
/// on it. At a right angle and beyond it stops, and a differential robot turns on the spot. `room`: metres
/// before and after the corner that the arc may take.
inline double time_lost_around(const Point2& in, const Point2& out, double stray, const Limits& limits,
                               double room = std::numeric_limits<double>::infinity()) {
  const double full = limits.max_speed;
  double stop = full / limits.max_acceleration;
  if (is_differential(limits))
    stop = full / deceleration(limits) + time_to_turn(std::acos(std::clamp(in.dot(out), -1.0, 1.0)), limits);
  if (in.dot(out) <= 0) return stop;
  double radius = arc_radius(in, out, stray);
  double tangent = std::sqrt(stray * (stray + 2 * radius));  // from the corner to the ends of the arc
  if (tangent > room) {
    radius *= room / tangent;
    tangent = room;
  }
  const double speed = speed_on_arc(radius, stray, limits, 0);
  if (speed == full) return 0;
  const double change = full - speed;
  constexpr double share_of_arc = 0.7;  // then the robot speeds up again
  const double on_arc = share_of_arc * 2 * tangent * (1 / speed - 1 / full);
  return std::min(change * change / (limits.max_acceleration * full) + on_arc, stop);
}

/// The same at a point of a path. Each of an edge's two corners may take half of the edge. 0 at the ends.
inline double time_lost_at(const Path& path, std::size_t k, double stray, const Limits& limits) {
  if (k == 0 || k + 1 >= path.size()) return 0;
  const Point2 in = path[k] - path[k - 1];
  const Point2 out = path[k + 1] - path[k];
  const double room = std::min(in.norm(), out.norm()) / 2;
  return time_lost_around(in.normalized(), out.normalized(), stray, limits, room);
}

}  // namespace coppice
