// A real robot that follows the body that this agent drives. The body is the robot's reference, and is as
// safe as ever. It takes as much more room as the robot may be off the reference. Where the robot falls
// behind, or is not seen, the reference waits. The argument and its assumptions are in docs/ros.md.
//
// Metres in the map frame; seconds, and metres per second, of the wall's clock.
#pragma once

#include <algorithm>
#include <optional>

#include "coppice/planning/geometry.h"
#include "messages/fleet_clock.h"

namespace coppice {

/// Where a robot was at a time, by its own odometry.
struct OdometrySample {
  WallTime at = 0;
  Point2 position = Point2::Zero();
  Point2 velocity = Point2::Zero();
};

struct TrackingSettings {
  double tolerance = 1;   ///< metres that the robot may be off its reference
  double patience = 0.5;  ///< seconds without odometry after which the reference waits
};

class Tracking {
 public:
  /// The reference drives at most at this share of the robot's speed. The rest is for catching up.
  static constexpr double share_of_speed = 0.9;

  explicit Tracking(const TrackingSettings& settings) : settings_(settings) {}

  const TrackingSettings& settings() const { return settings_; }
  double tolerance() const { return settings_.tolerance; }

  /// The robot was seen. `reference`: where the body was then.
  void see(const OdometrySample& robot, const Point2& reference) {
    seen_at_ = robot.at;
    position_ = robot.position;
    error_ = reference - robot.position;
  }
  const std::optional<Point2>& position() const { return position_; }

  /// The robot was seen of late, and is within the tolerance: it may drive.
  bool in_reach(WallTime now) const { return is_recent(now) && error_.norm() <= settings_.tolerance; }
  /// The robot is so close that its reference may drive, too.
  bool keeps_up(WallTime now) const {
    return is_recent(now) && error_.norm() <= largest_lag * settings_.tolerance;
  }
  bool is_recent(WallTime now) const { return position_ && now - seen_at_ <= settings_.patience; }
  /// Metres between the robot and its reference when the robot was last seen.
  double error() const { return error_.norm(); }

  /// The velocity with which the robot is to drive while its reference drives at `reference_velocity`.
  Point2 command(const Point2& reference_velocity, double max_speed, WallTime now) const {
    if (!in_reach(now)) return Point2::Zero();
    const Point2 wanted = reference_velocity + gain * error_;
    return wanted * std::min(1.0, max_speed / std::max(wanted.norm(), 1e-9));
  }

 private:
  static constexpr double largest_lag =
      0.5;  // of the tolerance: room for what the robot drives until both stand
  static constexpr double gain =
      1;  // m/s for each metre of error: slow in comparison with the lag of any drive

  TrackingSettings settings_;
  WallTime seen_at_ = 0;
  std::optional<Point2> position_{};
  Point2 error_ = Point2::Zero();
};

}  // namespace coppice
