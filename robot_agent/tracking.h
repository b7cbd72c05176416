// A robot that is elsewhere, and follows this agent's body: the body is its reference, as safe as ever, and
// takes as much more room as the robot may be off it. Where the robot falls behind, or nothing is heard of
// it, the reference waits. The argument, and what it assumes, is in docs/ros.md.
//
// Metres in the map frame; seconds, and metres per second, of the wall's clock.
#pragma once

#include <algorithm>
#include <optional>

#include "messages/fleet_clock.h"
#include "planning/geometry.h"

namespace coppice {

/// Where a robot was when, by its own odometry.
struct OdometrySample {
  WallTime at = 0;
  Point2 position = Point2::Zero();
  Point2 velocity = Point2::Zero();
};

struct TrackingSettings {
  double tolerance = 1;   ///< metres that the robot may be off its reference
  double patience = 0.5;  ///< seconds without a sighting
};

class Tracking {
 public:
  /// Of the robot's speed that its reference drives at most: the rest is for catching up.
  static constexpr double share_of_speed = 0.9;

  explicit Tracking(const TrackingSettings& settings) : settings_(settings) {}

  const TrackingSettings& settings() const { return settings_; }
  double tolerance() const { return settings_.tolerance; }

  /// `reference`: where the body was then.
  void see(const OdometrySample& robot, const Point2& reference) {
    seen_at_ = robot.at;
    position_ = robot.position;
    error_ = reference - robot.position;
  }
  const std::optional<Point2>& position() const { return position_; }

  /// Heard of, and within the tolerance: it may drive.
  bool in_reach(WallTime now) const { return is_recent(now) && error_.norm() <= settings_.tolerance; }
  /// And so close that its reference may, too.
  bool keeps_up(WallTime now) const {
    return is_recent(now) && error_.norm() <= largest_lag * settings_.tolerance;
  }
  bool is_recent(WallTime now) const { return position_ && now - seen_at_ <= settings_.patience; }
  /// Metres, when it was last seen.
  double error() const { return error_.norm(); }

  /// How the robot is to drive while its reference drives like that.
  Point2 command(const Point2& reference_velocity, double max_speed, WallTime now) const {
    if (!in_reach(now)) return Point2::Zero();
    const Point2 wanted = reference_velocity + gain * error_;
    return wanted * std::min(1.0, max_speed / std::max(wanted.norm(), 1e-9));
  }

 private:
  static constexpr double largest_lag = 0.5;  // of the tolerance: room for what it drives until both stand
  static constexpr double gain = 1;           // m/s for each metre: slow beside the lag of any drive

  TrackingSettings settings_;
  WallTime seen_at_ = 0;
  std::optional<Point2> position_{};
  Point2 error_ = Point2::Zero();
};

}  // namespace coppice
