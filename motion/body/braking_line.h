// The line of a decision: a robot executes a velocity for one period and then brakes in a straight line until
// it stands. A decision is safe if this line is clear of obstacles and of every point that a neighbour may
// cover meanwhile (docs/safety.md, L4 and L6).
//
// Metres in the map frame, seconds (one time base for all values that are compared), metres per second.
#pragma once

#include <cstddef>
#include <span>

#include "coppice/motion/kinematics.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "motion/body/promise.h"

namespace coppice {

/// The knowledge of a robot about another one.
struct Neighbour {
  Promise promise;
  double radius = 0;
  Limits limits;
  /// Seconds by which the promise's times may be off, in either direction; may be infinite. The neighbour may
  /// be ahead of or behind its promise by so much.
  double clock_error = 0;
  /// Whether this is a smaller robot that may be anywhere within the radius. A robot that is inside the
  /// radius may then not move at all.
  bool doubtful = false;
};

/// The robot keeps a twist for one period from time `from` on, and then brakes. Returns the index of the
/// first neighbour that may cover a part of that way until the robot stands; the number of neighbours if none
/// may.
std::size_t first_in_the_way(const Point2& position, const Twist& twist, double from, double radius,
                             const Limits& limits, double period, std::span<const Neighbour> neighbours);

/// Whether the same way until standstill keeps `radius` clear of obstacles.
bool clear_of_obstacles(const Point2& position, const Twist& twist, double radius, const Limits& limits,
                        double period, const ClearanceField& field);

}  // namespace coppice
