#include "robot_agent/process/reference_limits.h"

#include <algorithm>
#include <cmath>

#include "planning/quantities.h"

namespace coppice {

namespace {

// Shares of the tolerance that are for each fault. That of noise is for its deviation, of which a robot does
// not follow more than it has left (docs/ros.md).
constexpr double for_lag = 1.0 / 3;
constexpr double for_slip = 1.0 / 3;
constexpr double for_noise = 0.4;
// Shares of the noise: the deviations of the error and of the yaw that commands make up for.
constexpr double smoothed = 0.4;
constexpr double smoothed_yaw = 0.6;

// Of slip that turns a robot.
constexpr double of_angular_speed = 0.25;  // the rest is for turning along with the reference
constexpr double largest_heading = 0.3;    // radians, with which it steers against that

/// Seconds in which a reference comes to its largest turning, at most. A robot that takes longer cannot turn
/// along with it.
constexpr double longest_spin_up = 10;

/// `old_in_new`: old seconds in a new one.
Limits in_other_time(const Limits& limits, double old_in_new) {
  return {old_in_new * limits.max_speed, old_in_new * old_in_new * limits.max_acceleration,
          old_in_new * limits.max_angular_speed, old_in_new * old_in_new * limits.max_angular_acceleration};
}

/// A limit of a reference that drives at most at this speed.
double acceleration_at(double speed, const Limits& robot) {
  return std::min(Tracking::share_of_acceleration * robot.max_acceleration,
                  speed / Tracking::least_speeding_up);
}

/// How commands make up for errors of the position (Run::command).
Correction correction_at(double speed, Limits robot) {
  robot.max_acceleration = acceleration_at(speed, robot) / Tracking::share_of_acceleration;
  return Tracking::of_position(robot);
}

/// Commands make up for the usual lag. For the rest of it a robot goes on as before while its reference
/// drives otherwise: a holonomic one back, at most. If that takes long, corrections of one second keep it
/// closer.
bool bears_lag(const Follower& robot, double speed, double lag) {
  const double change = is_differential(robot.limits) ? speed : 2 * speed;
  const double behind_in_a_second = std::min(change, acceleration_at(speed, robot.limits) * 1.0);
  return (lag - Tracking::usual_lag) * behind_in_a_second <= for_lag * robot.tolerance;
}

/// A robot that is slower by its slip is behind until it makes up for that.
bool keeps_up(const Follower& robot, double speed, double slip) {
  const double missing = slip / (1 - slip) * speed;
  return correction_at(speed, robot.limits).error(missing) <= for_slip * robot.tolerance;
}

/// One wheel slips and the other does not: the robot turns. It stays so far beside its reference that it
/// steers against that.
bool keeps_its_heading(const Follower& robot, double speed, double slip) {
  const double half_track = wheels_at * robot.radius;
  const double turning = speed / half_track * unequal_wheels(slip);
  if (turning > of_angular_speed * robot.limits.max_angular_speed) return false;
  const double heading = Tracking::of_yaw(robot.limits).error(turning);
  if (heading > largest_heading) return false;
  const double aside = std::tan(heading) * (1 + Tracking::slow / Tracking::share_of_speed) * speed;
  return correction_at(speed, robot.limits).error(aside) <= for_slip * robot.tolerance;
}

/// Corrections follow the noise. A holonomic robot is commanded in its own frame, and so drives aside by the
/// noise of its yaw. The commands of a differential robot have no such part.
bool bears_noise(const Follower& robot, double speed, const Following& following) {
  const double most = for_noise * robot.tolerance;
  const double aside = is_differential(robot.limits) ? 0 : smoothed_yaw * speed * following.yaw_noise;
  const Correction correction = correction_at(speed, robot.limits);
  return correction.error(smoothed * following.noise) <= most && correction.error(aside) <= most;
}

bool keeps_within(const Follower& robot, double speed, const Following& following) {
  return bears_lag(robot, speed, following.lag) && keeps_up(robot, speed, following.slip) &&
         (!is_differential(robot.limits) || keeps_its_heading(robot, speed, following.slip)) &&
         bears_noise(robot, speed, following);
}

}  // namespace

double largest_reference_speed(const Follower& robot, const Following& following) {
  const double most = std::min(Tracking::share_of_speed * robot.limits.max_speed,
                               robot.tolerance / 2 / Tracking::largest_lag_in_time);
  return largest_kept(most, [&](double speed) { return keeps_within(robot, speed, following); });
}

Limits reference_limits(const Follower& robot, double scale) {
  const Limits by_the_wall = in_other_time(robot.limits, scale);
  double speed = Tracking::share_of_speed * by_the_wall.max_speed;
  if (robot.tolerance > 0) speed = largest_reference_speed({by_the_wall, robot.radius, robot.tolerance}, {});
  const double angular_acceleration = Tracking::share_of_acceleration * by_the_wall.max_angular_acceleration;
  Limits limits =
      in_other_time({.max_speed = speed,
                     .max_acceleration = acceleration_at(speed, by_the_wall),
                     .max_angular_speed = std::min(Tracking::share_of_speed * by_the_wall.max_angular_speed,
                                                   longest_spin_up * angular_acceleration),
                     .max_angular_acceleration = angular_acceleration},
                    1 / scale);
  limits.max_speed = std::min(limits.max_speed, longest_braking * limits.max_acceleration);
  limits.max_angular_speed =
      std::min(limits.max_angular_speed, longest_braking * limits.max_angular_acceleration);
  return limits;
}

}  // namespace coppice
