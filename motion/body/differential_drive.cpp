#include "motion/body/differential_drive.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace coppice {

namespace {

constexpr double turns_on_the_spot = 0.4;  // radians to the side of the heading, from which on it does
constexpr double rounding = 1e-9;          // radians: a robot that turned for less would never come to rest

/// The rate with which the robot turns by an angle and comes to rest there.
double turning_by(double angle, double present, const Limits& limits, double period) {
  const Limits angular{limits.max_angular_speed, limits.max_angular_acceleration};
  const double change = limits.max_angular_acceleration * period;
  const double left = std::abs(angle) < rounding ? 0 : std::abs(angle);
  const double last = std::min(change, left / period);
  const double rate = std::min(
      {angular.max_speed, left / period, std::max(last, speed_to_stop_within(left, angular, period))});
  return std::clamp(std::copysign(rate, angle), present - change, present + change);
}

}  // namespace

Twist feasible_twist(double speed, double turning, const Twist& present, double heading, const Limits& limits,
                     double period) {
  const double sideways = sideways_acceleration(limits);
  const double before = present.velocity.norm();
  const double change = deceleration(limits) * period;
  if (before * std::abs(turning) > sideways) turning = std::copysign(sideways / before, turning);
  const double half = turning * period / 2;
  const double chord = half == 0 ? 1 : std::sin(half) / half;  // its length, as a share of the arc's
  const double fastest = std::max(std::abs(turning), std::abs(present.angular_velocity));
  const double most = std::min(chord * limits.max_speed, sideways / std::max(fastest, 1e-9));
  const double next = std::max({0.0, before - change, std::min({speed, before + change, most})});
  const double direction = heading + half;
  return {next * Point2(std::cos(direction), std::sin(direction)), turning};
}

double turning_to(double yaw, const Twist& present, double heading, const Limits& limits, double period) {
  return turning_by(wrapped(yaw - heading), present.angular_velocity, limits, period);
}

Twist twist_towards(const Point2& wanted, const Twist& present, double heading, const Limits& limits,
                    double period) {
  const double speed = wanted.norm();
  const double angle = speed == 0 ? 0 : wrapped(std::atan2(wanted.y(), wanted.x()) - heading);
  const double along = std::abs(angle) > turns_on_the_spot ? 0 : speed * std::cos(angle);
  return feasible_twist(along, turning_by(angle, present.angular_velocity, limits, period), present, heading,
                        limits, period);
}

std::vector<Twist> twists_after(const Twist& present, double heading, const Limits& limits, double period) {
  constexpr std::array shares{-1.0, -0.5, 0.0, 0.5, 1.0};
  const double speed = present.velocity.norm();
  std::vector<Twist> twists;
  for (const double faster : shares) {
    for (const double turn : shares) {
      const double turning =
          std::clamp(present.angular_velocity + turn * limits.max_angular_acceleration * period,
                     -limits.max_angular_speed, limits.max_angular_speed);
      twists.push_back(feasible_twist(std::max(0.0, speed + faster * deceleration(limits) * period), turning,
                                      present, heading, limits, period));
    }
  }
  return twists;
}

}  // namespace coppice
