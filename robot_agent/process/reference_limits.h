// How fast the reference of a robot (robot_agent/control/tracking.h) may drive and turn, so that the robot
// keeps within its tolerance although it follows badly. The derivation is in docs/ros.md.
//
// Metres, seconds, radians; of the wall's clock.
#pragma once

#include "coppice/motion/kinematics.h"
#include "robot_agent/control/tracking.h"

namespace coppice {

/// A robot that follows a reference.
struct Follower {
  Limits limits{};
  double radius = 0;
  double tolerance = 0;  ///< that it may be off its reference; 0 if it is not known
};

/// Share of a wheel's speed that a usual robot loses at most.
inline constexpr double usual_slip = 0.08;

/// How badly a robot follows. By default as a usual robot, which all references allow for.
struct Following {
  double lag = Tracking::usual_lag;  ///< of its drive: time constant
  double slip = usual_slip;          ///< share of a wheel's speed that is lost
  double noise = 0;                  ///< of its position: standard deviation
  double yaw_noise = 0;              ///< the same of its yaw
};

/// From the middle of a differential robot to a wheel, as a share of its radius.
inline constexpr double wheels_at = 0.8;

/// The angle by which one wheel that slips turns a robot on each metre of its way, times half its track.
inline double unequal_wheels(double slip) {
  return slip / (2 - slip);
}

/// What the reference of a robot may do: with it a usual robot keeps within its tolerance. `scale`: of the
/// run's clock. Both limits are in its time.
Limits reference_limits(const Follower& robot, double scale);

/// With which the robot keeps within its tolerance where its reference drives.
double largest_reference_speed(const Follower& robot, const Following& following);

/// The largest value up to `most` that is kept, if all smaller ones are.
template <class Kept>
double largest_kept(double most, Kept&& kept) {
  if (kept(most)) return most;
  double least = 0;
  for (int k = 0; k < 40; ++k) {
    const double middle = (least + most) / 2;
    (kept(middle) ? least : most) = middle;
  }
  return least;
}

}  // namespace coppice
