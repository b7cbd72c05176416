#include "robot_agent/control/tracking.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coppice {

namespace {

// Speeds for each metre of error, and turns for each radian: slow in comparison with the lag of any drive.
constexpr double gain = 1;
constexpr double turning_gain = 2;
constexpr double late = 0.3;  // seconds until an acceleration takes effect, at most
// Deviations of the smoothed errors: odometry is noisy, and errors change slowly. A robot that stands off its
// reference by its noise alone must not turn to it.
constexpr double driving_noise = 0.15;      // of the tolerance
constexpr double standing_noise = 0.05;     // the same
constexpr double driving_yaw_noise = 0.08;  // radians
constexpr double standing_yaw_noise = 0.01;
constexpr double most_while_driving = 10;    // samples: with more, a robot swings
constexpr double most_while_standing = 500;  // the same: they take 25 s
constexpr double deviations = 3;             // of an error that noise alone hardly ever makes

constexpr double heads_there = 0.3;   // radians, within which a robot that turns to its reference drives
constexpr double standing_yaw = 0.2;  // radians: a robot that stands turns for more in any case
constexpr double rest = 0.3;          // seconds
constexpr double settled = 0.3;       // of the error from which on it comes back or turns

/// After which the noise of a smoothed error, with geometric weights, has become that small.
double samples_for(double noise, double smoothed) {
  return (1 + noise * noise / (smoothed * smoothed)) / 2;
}

double at_most(double value, double most) {
  return std::clamp(value, -most, most);
}

}  // namespace

Tracking::Samples Tracking::samples_of_error(const TrackingSettings& settings, double tolerance) {
  const double driving = samples_for(settings.noise, driving_noise * tolerance);
  const double standing = samples_for(settings.noise, standing_noise * tolerance);
  return {std::clamp(driving, 3.3, most_while_driving), std::clamp(standing, 10.0, most_while_standing)};
}

Tracking::Samples Tracking::samples_of_yaw_error(const TrackingSettings& settings) {
  const double driving = samples_for(settings.yaw_noise, driving_yaw_noise);
  const double standing = samples_for(settings.yaw_noise, standing_yaw_noise);
  return {std::clamp(driving, 2.0, most_while_driving), std::clamp(standing, 5.0, most_while_standing)};
}

double Correction::speed(double error) const {
  const double stops = speed_to_stop_within(std::abs(error), {.max_acceleration = reserve}, late);
  return std::copysign(std::min(gain * std::abs(error), stops), error);
}

double Correction::error(double speed) const {
  return std::max(speed / gain, late * speed + speed * speed / (2 * reserve));
}

/// Of a differential robot beside its reference, too: it accelerates less to the side than it brakes.
Correction Tracking::of_position(const Limits& limits) {
  const double most = is_differential(limits) ? sideways_acceleration(limits) : limits.max_acceleration;
  return {gain, (1 - share_of_acceleration) * most};
}

/// A reference seldom changes its turning while it turns.
Correction Tracking::of_yaw(const Limits& limits) {
  return {turning_gain, limits.max_angular_acceleration / 2};
}

void Tracking::see(const OdometrySample& robot, const Point2& reference, double reference_yaw) {
  samples_ = is_recent(robot.at) ? std::min(samples_ + 1, enough_samples) : 1;
  if (samples_ == 1) of_error_ = of_yaw_error_ = 0;
  const bool stands = command_.linear.isZero(0) && command_.angular == 0;
  const auto most = [&](const Samples& of) { return stands ? of.while_standing : of.while_driving; };
  of_error_ = std::min(of_error_ + 1, most(most_of_error_));
  of_yaw_error_ = std::min(of_yaw_error_ + 1, most(most_of_yaw_error_));
  error_ += (reference - robot.position - error_) / of_error_;
  yaw_error_ = wrapped(yaw_error_ + wrapped(reference_yaw - robot.yaw - yaw_error_) / of_yaw_error_);
  yaw_ = wrapped(yaw_ + wrapped(robot.yaw - yaw_) / of_yaw_error_);
  last_ = robot;
  lags_ = error() > (lags_ ? returns_from : largest_lag) * tolerance_ ||
          std::abs(yaw_error_) > (lags_ ? standing_yaw : largest_yaw_lag);
}

bool Tracking::rests_within(double metres, double radians, WallTime now) {
  if (error() > metres || std::abs(yaw_error_) > radians || comes_back_ || command_.angular != 0 ||
      !knows_yaw_error(radians))
    away_at_ = now;
  return now - away_at_ >= rest;
}

DriveCommand Tracking::chosen(const Twist& reference, const Limits& limits, const Rest& rest, WallTime now) {
  if (!in_reach(now) || samples_ < enough_samples) return {};
  if (!is_differential(limits)) return glide(reference, limits);
  if (reference.velocity.isZero(0)) return come_to(reference.angular_velocity, limits, rest);
  comes_back_ = false;
  turns_along_ = false;
  return follow(reference, limits);
}

/// A holonomic robot drives as its reference, and towards it.
DriveCommand Tracking::glide(const Twist& reference, const Limits& limits) const {
  const Point2 towards = error_ / std::max(error(), 1e-9);
  const Point2 wanted = reference.velocity + of_position(limits).speed(error()) * towards;
  return {rotated(wanted * std::min(1.0, limits.max_speed / std::max(wanted.norm(), 1e-9)), -yaw_), 0};
}

/// A differential robot heads as its reference, and towards it if it is beside (Hoffmann et al., "Autonomous
/// Automobile Trajectory Tracking for Off-Road Driving", 2007).
DriveCommand Tracking::follow(const Twist& reference, const Limits& limits) const {
  const Correction correction = of_position(limits);
  const double reference_yaw = last_->yaw + yaw_error_;
  const double speed = rotated(reference.velocity, -reference_yaw).x();  // below 0 at the end of braking
  const Point2 error = rotated(error_, -reference_yaw);                  // ahead of the robot, and beside it
  const double aside =
      std::atan2(correction.speed(error.y()), std::max(speed, 0.0) + slow * limits.max_speed);
  const double turning = reference.angular_velocity + turning_by(yaw_error_ + aside, limits);
  const double ahead = speed * std::cos(yaw_error_) + correction.speed(error.x());
  return {{std::clamp(ahead, 0.0, limits.max_speed), 0}, at_most(turning, limits.max_angular_speed)};
}

/// A robot that is off its reference, which stands, turns to it, drives there, and turns as it does. Each of
/// these begins at a larger error than it ends at: neither noise nor slip makes the robot begin at once
/// again.
DriveCommand Tracking::come_to(double turning, const Limits& limits, const Rest& rest) {
  const double near = std::min(rest.metres, returns_from * tolerance_);
  comes_back_ = comes_back_ ? error() > settled * near : error() > near && knows_error(near);
  if (comes_back_) return drive_back(limits);
  const double off = std::min(rest.radians, standing_yaw);
  turns_along_ = turning != 0 || (turns_along_ ? std::abs(yaw_error_) > settled * off
                                               : std::abs(yaw_error_) > off && knows_yaw_error(off));
  if (!turns_along_) return {};
  return {Point2::Zero(), at_most(turning + turning_by(yaw_error_, limits), limits.max_angular_speed)};
}

/// Noise alone does not make such an error.
bool Tracking::knows_error(double metres) const {
  const double enough = samples_for(settings_.noise, metres / deviations);
  return of_error_ >= std::min(enough, most_of_error_.while_standing);
}

bool Tracking::knows_yaw_error(double radians) const {
  const double enough = samples_for(settings_.yaw_noise, radians / deviations);
  return of_yaw_error_ >= std::min(enough, most_of_yaw_error_.while_standing);
}

/// A robot drives straight to its reference, which stands. Beyond its tolerance it comes hardly closer to
/// anything that keeps clear of the reference (docs/ros.md). Its speed changes steadily with its bearing.
DriveCommand Tracking::drive_back(const Limits& limits) const {
  const Correction correction{gain, sideways_acceleration(limits)};
  const double speed = std::min(correction.speed(error()), limits.max_speed);
  const double bearing = std::atan2(error_.y(), error_.x()) - last_->yaw;
  const double ahead = speed * std::max(0.0, 1 - std::abs(wrapped(bearing)) / heads_there);
  return {{ahead, 0}, at_most(turning_by(bearing, limits), limits.max_angular_speed)};
}

/// How the robot turns by an angle. A robot that turns already goes on to the same side unless the other way
/// is less than a quarter turn: a robot with its back to where it should head would turn to and fro, and
/// wheels that slip would carry it away.
double Tracking::turning_by(double angle, const Limits& limits) const {
  double left = wrapped(angle);
  if (command_.angular * left < 0 && std::abs(left) > std::numbers::pi / 2)
    left += std::copysign(2 * std::numbers::pi, command_.angular);
  return of_yaw(limits).speed(left);
}

}  // namespace coppice
