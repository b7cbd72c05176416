// What a robot binds itself to in every state that it sends, and what follows for the others.
//
// A robot decides one control period ahead: at the time `stamp` it moves with `velocity`, and has already
// chosen the velocity of the period after that. So everybody who hears the state knows its motion until
// `expiry`; beyond that, only its limits bound it. Two bounds hold at a time s after the expiry, and a robot
// lies within both:
//   - it is at most max_speed * s from where it was at the expiry;
//   - it is at most max_acceleration * s * (s + period) / 2 from where its velocity at the expiry would have
//     taken it, if s is a number of whole periods; in between, what follows linearly (velocities change in
//     steps, at the period's beginning).
// A robot that stands may bind itself for longer, by a late expiry: others can pass it closely then. One that
// is failed stands for ever.
//
// Where clocks may differ, a robot may be ahead or behind on its commitment by as much time.
//
// Metres in the map frame, seconds (one time base for everything that is compared), metres per second.
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

/// Another robot as far as this one knows.
struct Neighbour {
  Commitment commitment;
  double radius = 0;
  Limits limits;
  double clock_error =
      0;  ///< seconds by which the commitment's times may be off, either way; may be infinite
  /// A smaller robot that may be anywhere within the radius: none who finds itself inside moves at all.
  bool doubtful = false;
};

/// Where a robot stands in the end that brakes in a straight line after its commitment.
Point2 rest_after(const Commitment& commitment, const Limits& limits, double period);

/// Where it may have come to rest if up to `unheard` later decisions were not heard: points along its
/// heading, at most `step` metres apart, from rest_after to where it would stand had it sped up each time.
std::vector<Point2> rests_after(const Commitment& commitment, const Limits& limits, double period,
                                int unheard, double step);

/// Where this robot will be if it executes `velocity` for one period from `from` on and then brakes in a
/// straight line: the place of the first neighbour in the list that may cover something of that until it
/// stands; the size of the list if none may.
std::size_t first_in_the_way(const Point2& position, const Point2& velocity, double from, double radius,
                             const Limits& limits, double period, std::span<const Neighbour> neighbours);

/// The same for obstacles: the straight line until standstill keeps `radius` clear.
bool clear_of_obstacles(const Point2& position, const Point2& velocity, double radius, const Limits& limits,
                        double period, const ClearanceField& field);

}  // namespace coppice
