// The motion of a robot's disc: its velocity is constant within each control period, and changes by at most
// max_acceleration times the period from one period to the next.
//
// A differential robot drives forward along its heading and turns at a constant rate within each period, so
// it drives on arcs (Siegwart, Nourbakhsh, "Introduction to Autonomous Mobile Robots", 2004, section 3.2).
// Its velocity here is that of the chord from the arc's beginning to its end. The heading turns by half
// before the chord and by half after it.
//
// Metres in the map frame, seconds, metres per second, metres per second squared, radians.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/planning/geometry.h"

namespace coppice {

/// Seconds. The whole fleet decides at 20 Hz.
inline constexpr double control_period = 0.05;

/// Radians a second. A robot turns by at most half a turn in a period: from there on a chord says little of
/// its arc.
inline constexpr double fastest_turning = std::numbers::pi / control_period;

struct Limits {
  double max_speed = 0;         ///< above 0
  double max_acceleration = 0;  ///< above 0
  /// Radians a second: of a differential robot. 0: a holonomic robot, which moves in any direction at once.
  double max_angular_speed = 0;
  double max_angular_acceleration = 0;  ///< radians per second squared; above 0 for a differential robot
};

inline bool is_differential(const Limits& limits) {
  return limits.max_angular_speed > 0;
}

/// What a robot does in one period.
struct Twist {
  Point2 velocity = Point2::Zero();
  double angular_velocity = 0;  ///< radians a second; 0 for a holonomic robot
  bool operator==(const Twist&) const = default;
};

/// The same angle from -pi to pi.
inline double wrapped(double angle) {
  return std::remainder(angle, 2 * std::numbers::pi);
}

inline Point2 rotated(const Point2& v, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

/// A differential robot accelerates to the side on its arcs. That share of max_acceleration is kept for it,
/// and braking takes the rest: so no velocity changes by more than max_acceleration times the period, also if
/// the robot brakes in the middle of an arc.
inline double sideways_acceleration(const Limits& limits) {
  constexpr double share = 0.6;
  return share * limits.max_acceleration;
}
inline double deceleration(const Limits& limits) {
  constexpr double share = 0.8;  // 0.6 squared and 0.8 squared make 1
  return is_differential(limits) ? share * limits.max_acceleration : limits.max_acceleration;
}

/// Seconds from full speed to standstill.
inline double braking_time(const Limits& limits) {
  return limits.max_speed / deceleration(limits);
}

/// Metres between an arc of one period and its chord, at most. An arc that turns by an angle is c/2
/// tan(angle/4) off its chord of length c. The fastest turn has the largest distance, although it has the
/// shortest chord. The robot turns by at most half a turn in a period (fastest_turning).
inline double off_the_chord(const Limits& limits, double period) {
  if (!is_differential(limits)) return 0;
  const double chord = sideways_acceleration(limits) / limits.max_angular_speed * period;
  return chord / 2 * std::tan(limits.max_angular_speed * period / 4);
}

/// The radius that a disc of `radius` needs where it drives: a differential robot is beside its chords on its
/// arcs. All that plan for a robot take this radius, so that the trees of one serve the others.
inline double driving_radius(double radius, const Limits& limits) {
  return radius + off_the_chord(limits, control_period);
}

/// What follows after one period of braking: in a straight line, unless the robot turns.
inline Twist braked(const Twist& twist, const Limits& limits, double period) {
  const double speed = twist.velocity.norm();
  const double drop = deceleration(limits) * period;
  const Point2 slower = speed <= drop ? Point2::Zero() : Point2(twist.velocity * ((speed - drop) / speed));
  if (twist.angular_velocity == 0) return {slower, 0};
  const double most = limits.max_angular_acceleration * period;
  const double turning = twist.angular_velocity - std::clamp(twist.angular_velocity, -most, most);
  return {rotated(slower, (twist.angular_velocity + turning) / 2 * period), turning};
}

/// Metres that a robot still travels if it brakes from now on. The first drop of speed happens at once: the
/// sum over the periods of (speed - k drop) period for k = 1, 2, ...
inline double braking_distance(double speed, const Limits& limits, double period) {
  const double drop = deceleration(limits) * period;
  const double periods = std::floor(speed / drop);
  return period * (periods * speed - drop * periods * (periods + 1) / 2);
}

/// Number of periods in which a robot still moves if it brakes from now on. The first drop of speed happens
/// at once.
inline int braking_periods(double speed, const Limits& limits, double period) {
  return std::max(0, static_cast<int>(std::ceil(speed / (deceleration(limits) * period))) - 1);
}

/// The highest speed from which braking over `distance` ends in standstill. The bound holds in continuous
/// time, with room for the period before braking begins.
inline double speed_to_stop_within(double distance, const Limits& limits, double period) {
  const double lag = deceleration(limits) * period;
  return std::max(0.0, std::sqrt(lag * lag + 2 * deceleration(limits) * distance) - lag);
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

/// Seconds that a robot needs at least to come so many metres, if it drives at this speed now.
inline double least_time(double metres, double speed, const Limits& limits) {
  const double a = limits.max_acceleration;
  const double until_full = (limits.max_speed * limits.max_speed - speed * speed) / (2 * a);  // metres
  if (metres <= until_full) return (std::sqrt(speed * speed + 2 * a * metres) - speed) / a;
  return (limits.max_speed - speed) / a + (metres - until_full) / limits.max_speed;
}

/// Seconds in which a robot turns on the spot, from rest to rest. 0 for a holonomic robot.
inline double time_to_turn(double angle, const Limits& limits) {
  if (!is_differential(limits)) return 0;
  return free_flow_time(std::abs(angle), {limits.max_angular_speed, limits.max_angular_acceleration});
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
