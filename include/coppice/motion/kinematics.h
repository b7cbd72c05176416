// The motion of a robot's disc: its velocity is constant within each control period, and changes by at most
// max_acceleration times the period from one period to the next.
//
// Metres in the map frame, seconds, metres per second, metres per second squared.
#pragma once

#include <algorithm>
#include <cmath>

#include "coppice/planning/geometry.h"

namespace coppice {

struct Limits {
  double max_speed = 0;         ///< above 0
  double max_acceleration = 0;  ///< above 0
};

/// The velocity after one period of braking in a straight line.
inline Point2 braked(const Point2& velocity, const Limits& limits, double period) {
  const double speed = velocity.norm();
  const double drop = limits.max_acceleration * period;
  return speed <= drop ? Point2::Zero() : Point2(velocity * ((speed - drop) / speed));
}

/// Metres that a robot still travels if it brakes from now on. The first drop of speed, max_acceleration
/// times the period, happens at once: the sum over the periods of (speed - k drop) period for k = 1, 2, ...
inline double braking_distance(double speed, const Limits& limits, double period) {
  const double drop = limits.max_acceleration * period;
  const double periods = std::floor(speed / drop);
  return period * (periods * speed - drop * periods * (periods + 1) / 2);
}

/// Number of periods in which a robot still moves if it brakes from now on. The first drop of speed happens
/// at once.
inline int braking_periods(double speed, const Limits& limits, double period) {
  return std::max(0, static_cast<int>(std::ceil(speed / (limits.max_acceleration * period))) - 1);
}

/// The highest speed from which braking over `distance` ends in standstill. The bound holds in continuous
/// time, with room for the period before braking begins.
inline double speed_to_stop_within(double distance, const Limits& limits, double period) {
  const double lag = limits.max_acceleration * period;
  return std::max(0.0, std::sqrt(lag * lag + 2 * limits.max_acceleration * distance) - lag);
}

/// Seconds from standstill to standstill along `length` metres of a straight line, with nobody in the way.
inline double free_flow_time(double length, const Limits& limits) {
  const double speeding_up = limits.max_speed / limits.max_acceleration;
  return length > limits.max_speed * speeding_up ? length / limits.max_speed + speeding_up
                                                 : 2 * std::sqrt(length / limits.max_acceleration);
}

/// Seconds that a robot loses because it speeds up from standstill.
inline double speeding_up(const Limits& limits) {
  return limits.max_speed / limits.max_acceleration / 2;
}

/// The velocity nearest to `wanted` that `limits` allow one period after `current`.
inline Point2 within_limits(const Point2& wanted, const Point2& current, const Limits& limits,
                            double period) {
  const double reach = limits.max_acceleration * period;
  Point2 target = wanted;
  if (const double speed = target.norm(); speed > limits.max_speed) target *= limits.max_speed / speed;
  const Point2 change = target - current;
  const double size = change.norm();
  return size <= reach ? target : Point2(current + change * (reach / size));
}

}  // namespace coppice
