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
// Metres in the map frame, seconds (one time base for all values that are compared), metres per second.
#pragma once

#include <vector>

#include "coppice/motion/kinematics.h"
#include "coppice/planning/geometry.h"

namespace coppice {

struct Promise {
  double stamp = 0;
  Point2 position = Point2::Zero();  ///< at stamp
  Point2 velocity = Point2::Zero();  ///< from stamp to decision_time
  double decision_time = 0;
  Point2 next_velocity = Point2::Zero();  ///< from decision_time to expiry
  double expiry = 0;
  double yaw = 0;                    ///< radians, at stamp; of a differential robot, like the next two
  double angular_velocity = 0;       ///< radians a second, from stamp to decision_time
  double next_angular_velocity = 0;  ///< from decision_time to expiry

  Point2 position_at_decision() const { return position + (decision_time - stamp) * velocity; }
  Point2 position_at_expiry() const {
    return position_at_decision() + (expiry - decision_time) * next_velocity;
  }
  /// The same promise by a clock that is ahead by `offset` seconds.
  Promise shifted_by(double offset) const {
    Promise shifted = *this;
    shifted.stamp += offset;
    shifted.decision_time += offset;
    shifted.expiry += offset;
    return shifted;
  }
  bool stands() const { return velocity.isZero(0) && next_velocity.isZero(0); }
  bool operator==(const Promise&) const = default;
};

/// Where a robot comes to rest if it brakes after its promise.
Point2 rest_after(const Promise& promise, const Limits& limits, double period);

/// Where the robot may have come to rest if up to `unheard` later decisions were not received: points along
/// its heading, at most `step` metres apart, from rest_after to where it would stand if it had sped up each
/// time.
std::vector<Point2> rests_after(const Promise& promise, const Limits& limits, double period, int unheard,
                                double step);

}  // namespace coppice
