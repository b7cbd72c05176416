// The twists that a differential robot can take next, and the one that comes closest to a velocity.
//
// The robot turns towards the velocity, and drives as fast as its heading allows. If the velocity lies far to
// the side it turns on the spot.
//
// Metres in the map frame, seconds, metres per second, radians.
#pragma once

#include <vector>

#include "coppice/motion/kinematics.h"

namespace coppice {

/// `heading`: when the twist that follows on `present` begins.
Twist twist_towards(const Point2& wanted, const Twist& present, double heading, const Limits& limits,
                    double period);

/// The twist whose speed and rate of turning are close to these, and that the robot can take. Neither the one
/// before nor this one accelerates more to the side than is allowed, whichever is faster. The robot turns as
/// fast as it is told, as far as its speed allows.
Twist feasible_twist(double speed, double turning, const Twist& present, double heading, const Limits& limits,
                     double period);

/// The angular velocity with which the robot comes to rest at a yaw.
double turning_to(double yaw, const Twist& present, double heading, const Limits& limits, double period);

/// Twists of all speeds and turns that can follow on `present`.
std::vector<Twist> twists_after(const Twist& present, double heading, const Limits& limits, double period);

}  // namespace coppice
