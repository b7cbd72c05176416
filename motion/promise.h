// The promise to which a robot binds itself in each state that it sends, and what follows for the others.
//
// A robot decides one control period ahead: at the time `stamp` it moves with `velocity`, and has already
// chosen the velocity of the following period. So a receiver of the state knows the robot's motion until
// `expiry`. After that, only its limits bound its motion. Two bounds hold at s seconds after the expiry, and
// a robot lies within both:
//   - It is at most max_speed * s from its position at the expiry.
//   - It is at most max_acceleration * s * (s + period) / 2 from where its velocity at the expiry would have
//     taken it, if s is a whole number of periods; in between, the bound is linear (velocities change in
//     steps, at the beginning of a period).
// A standing robot may bind itself for longer, by a late expiry; then others can pass it closely. A failed
// robot stands for ever.
//
// If clocks differ, a robot may be ahead of or behind its commitment by the clock error.
//
// Metres in the map frame, seconds (one time base for all values that are compared), metres per second.
#pragma once

#include <span>
#include <vector>

#include "motion/kinematics.h"
#include "planning/clearance_field.h"
#include "planning/geometry.h"

namespace coppice {

struct Commitment {
  double stamp = 0;
  Point2 position = Point2::Zero();  ///< at stamp
  Point2 velocity = Point2::Zero();  ///< from stamp to turn
  double turn = 0;
  Point2 next_velocity = Point2::Zero();  ///< from turn to expiry
  double expiry = 0;

  Point2 position_at_turn() const { return position + (turn - stamp) * velocity; }
  Point2 position_at_expiry() const { return position_at_turn() + (expiry - turn) * next_velocity; }
};

/// The knowledge of a robot about another one.
struct Neighbour {
  Commitment commitment;
  double radius = 0;
  Limits limits;
  double clock_error =
      0;  ///< seconds by which the commitment's times may be off, in either direction; may be infinite
  /// Whether this is a smaller robot that may be anywhere within the radius. A robot that is inside the
  /// radius may then not move at all.
  bool doubtful = false;
};

/// Where a robot comes to rest if it brakes in a straight line after its commitment.
Point2 rest_after(const Commitment& commitment, const Limits& limits, double period);

/// Where the robot may have come to rest if up to `unheard` later decisions were not received: points along
/// its heading, at most `step` metres apart, from rest_after to where it would stand if it had sped up each
/// time.
std::vector<Point2> rests_after(const Commitment& commitment, const Limits& limits, double period,
                                int unheard, double step);

/// The robot executes `velocity` for one period from time `from` on, and then brakes in a straight line.
/// Returns the index of the first neighbour that may cover a part of that way until the robot stands; the
/// number of neighbours if none may.
std::size_t first_in_the_way(const Point2& position, const Point2& velocity, double from, double radius,
                             const Limits& limits, double period, std::span<const Neighbour> neighbours);

/// Whether the straight line until standstill keeps `radius` clear of obstacles.
bool clear_of_obstacles(const Point2& position, const Point2& velocity, double radius, const Limits& limits,
                        double period, const ClearanceField& field);

}  // namespace coppice
