#include "robot_agent/tracking.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coppice {

namespace {

// Speeds for each metre of error, and turns for each radian: slow in comparison with the lag of any drive.
constexpr double gain = 1;
constexpr double turning_gain = 2;
// Shares of a new sample: odometry is noisy, and errors change slowly. A robot that stands off its reference
// by its noise alone must not turn to it.
struct Shares {
  double position;
  double yaw;
};
constexpr Shares while_driving{0.3, 0.5};
constexpr Shares while_standing{0.1, 0.2};

constexpr double heads_there = 0.3;    // radians, within which a robot drives while it turns
constexpr double standing_yaw = 0.02;  // radians: a robot that stands does not turn for less
constexpr double rest = 0.3;           // seconds
constexpr double slow = 0.2;           // of the largest speed: a slower robot heads along with its reference
constexpr double settled = 0.3;        // of the distance from which on it comes back

double at_most(double value, double most) {
  return std::clamp(value, -most, most);
}

}  // namespace

void Tracking::see(const OdometrySample& robot, const Point2& reference, double reference_yaw) {
  samples_ = is_recent(robot.at) ? std::min(samples_ + 1, enough_samples) : 1;
  const bool stands = command_.linear.isZero(0) && command_.angular == 0;
  Shares share = stands ? while_standing : while_driving;
  share.position = std::max(share.position, 1.0 / samples_);  // the mean of the first ones
  share.yaw = std::max(share.yaw, 1.0 / samples_);
  error_ += share.position * (reference - robot.position - error_);
  yaw_error_ = wrapped(yaw_error_ + share.yaw * wrapped(reference_yaw - robot.yaw - yaw_error_));
  last_ = robot;
}

bool Tracking::rests_within(double metres, double radians, WallTime now) {
  if (error() > metres || std::abs(yaw_error_) > radians || comes_back_ || command_.angular != 0)
    away_at_ = now;
  return now - away_at_ >= rest || now < away_at_;  // the clock may have been set back
}

DriveCommand Tracking::chosen(const Twist& reference, const Limits& limits, double settles, WallTime now) {
  if (!in_reach(now) || samples_ < enough_samples) return {};
  if (error() > tolerance_) return drive_back(limits);
  if (!is_differential(limits)) {
    const Point2 wanted = reference.velocity + gain * error_;
    return {rotated(wanted * std::min(1.0, limits.max_speed / std::max(wanted.norm(), 1e-9)), -last_->yaw),
            0};
  }
  if (reference.velocity.isZero(0)) return come_to(reference.angular_velocity, limits, settles);
  comes_back_ = false;
  return follow(reference, limits);
}

/// The robot heads as its reference, and towards it if it is beside (Hoffmann et al., "Autonomous Automobile
/// Trajectory Tracking for Off-Road Driving", 2007).
DriveCommand Tracking::follow(const Twist& reference, const Limits& limits) const {
  const double speed = reference.velocity.norm();
  const double reference_yaw = last_->yaw + yaw_error_;
  const Point2 error = rotated(error_, -reference_yaw);  // ahead of the robot, and beside it
  const double aside = std::atan2(gain * error.y(), speed + slow * limits.max_speed);
  const double turning = reference.angular_velocity + turning_gain * wrapped(yaw_error_ + aside);
  const double ahead = speed * std::cos(yaw_error_) + gain * error.x();
  return {{std::clamp(ahead, 0.0, limits.max_speed), 0}, at_most(turning, limits.max_angular_speed)};
}

/// A robot that is off its reference, which stands, turns to it, drives there, and turns as it does.
DriveCommand Tracking::come_to(double turning, const Limits& limits, double settles) {
  const double distance = error();
  comes_back_ = samples_ >= enough_samples && distance > (comes_back_ ? settled * settles : settles);
  if (!comes_back_) {
    const double left = std::abs(yaw_error_) < standing_yaw ? 0 : yaw_error_;
    return {Point2::Zero(), at_most(turning + turning_gain * left, limits.max_angular_speed)};
  }
  return drive_back(limits);
}

/// A robot drives straight to its reference, which stands. Beyond its tolerance it comes hardly closer to
/// anything that keeps clear of the reference (docs/ros.md).
DriveCommand Tracking::drive_back(const Limits& limits) const {
  const double speed = std::min(gain * error(), limits.max_speed);
  const double bearing = wrapped(std::atan2(error_.y(), error_.x()) - last_->yaw);
  if (!is_differential(limits)) return {speed * Point2(std::cos(bearing), std::sin(bearing)), 0};
  const double ahead = std::abs(bearing) < heads_there ? speed * std::cos(bearing) : 0;
  return {{ahead, 0}, at_most(turning_gain * bearing, limits.max_angular_speed)};
}

}  // namespace coppice
