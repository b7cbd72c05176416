// A real robot that follows the body that this agent drives. The body is the robot's reference, and is as
// safe as ever. It takes as much more room as the robot may be off the reference: the tracking
// tolerance of its mission.
// Where the robot falls behind, or is not seen, the reference waits. The argument and its assumptions are in
// docs/ros.md.
//
// Metres in the map frame, radians; seconds, and metres per second, of the wall's clock.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "coppice/motion/kinematics.h"
#include "coppice/planning/geometry.h"
#include "messages/fleet_clock.h"

namespace coppice {

/// Where a robot was at a time, by its own odometry.
struct OdometrySample {
  WallTime at = 0;
  Point2 position = Point2::Zero();
  Point2 velocity = Point2::Zero();
  double yaw = 0;
  double angular_velocity = 0;
};

/// How a robot is to drive, in its own frame: x ahead; y to the side, where its yaw grows.
struct DriveCommand {
  Point2 linear = Point2::Zero();  ///< the second is 0 for a differential robot
  double angular = 0;              ///< 0 for a holonomic robot
};

struct TrackingSettings {
  double patience = 0.5;  ///< seconds without odometry after which the reference waits
  // Standard deviations of where the robot seems to be and head. The errors of noisier poses are smoothed
  // more.
  double noise = 0.02;      ///< metres
  double yaw_noise = 0.02;  ///< radians
};

/// How close a robot comes to its reference while that stands.
struct Rest {
  double metres = 0;
  double radians = 0;
};

/// How fast a robot makes up for an error, in metres or radians. As fast as it can come to rest again: while
/// its reference brakes, it brakes harder by its reserve at most.
struct Correction {
  double gain = 0;     ///< speed for each metre, and turning for each radian, of a small error
  double reserve = 0;  ///< of acceleration

  double speed(double error) const;
  /// The error at which it makes up for a speed that it lacks.
  double error(double speed) const;
};

class Tracking {
 public:
  /// The reference drives and turns at most at this share of the robot's speeds. The rest is for catching up.
  static constexpr double share_of_speed = 0.9;
  /// The same of its accelerations. A robot that has caught up with a reference that brakes has to brake
  /// harder than that.
  static constexpr double share_of_acceleration = 0.8;
  /// Seconds in which a reference comes to its full speed, at least. Commands that make up for the lag of a
  /// quicker one would be beyond the robot's speeds.
  static constexpr double least_speeding_up = 0.25;
  /// Share of the largest speed. A slower robot heads along with its reference.
  static constexpr double slow = 0.2;
  /// Seconds by which a command is ahead, because it takes effect late.
  static constexpr double lead = 0.1;
  /// Seconds, of the drive of a usual robot (time constant). Commands make up for it.
  static constexpr double usual_lag = 0.1;
  /// Seconds in which a reference comes half its tolerance ahead of a robot, at least: so slowly it drives.
  static constexpr double largest_lag_in_time = 0.13;

  /// Seconds that a robot drives on if commands stay away, and the time in which it stops then.
  static constexpr double drives_on = 0.75;

  /// `tolerance`: metres that the robot may be off its reference. `max_speed`: of the robot.
  Tracking(const TrackingSettings& settings, double tolerance, double max_speed)
      : settings_(settings),
        tolerance_(tolerance),
        farthest_(tolerance + std::max(tolerance, drives_on * max_speed)),
        most_of_error_(samples_of_error(settings, tolerance)),
        most_of_yaw_error_(samples_of_yaw_error(settings)) {}

  /// How a robot makes up for errors. `limits`: the robot's.
  static Correction of_position(const Limits& limits);
  static Correction of_yaw(const Limits& limits);

  double tolerance() const { return tolerance_; }

  /// The robot was seen. `reference`, `reference_yaw`: where the body was then.
  void see(const OdometrySample& robot, const Point2& reference, double reference_yaw);
  /// The robot was seen of late, and is so close that it may drive.
  bool in_reach(WallTime now) const { return is_recent(now) && error() <= farthest_; }
  /// The robot is so close that its reference may drive, too.
  bool keeps_up(WallTime now) const { return is_recent(now) && samples_ >= enough_samples && !lags_; }
  bool is_recent(WallTime now) const { return last_ && now - last_->at <= settings_.patience; }
  /// Metres from the robot to its reference when the robot was last seen.
  double error() const { return error_.norm(); }
  /// The robot has been so close to its reference for a while, and headed as it did.
  bool rests_within(double metres, double radians, WallTime now);

  /// How the robot is to drive while its reference drives as `reference` says. `limits`: the robot's.
  DriveCommand command(const Twist& reference, const Limits& limits, const Rest& rest, WallTime now) {
    command_ = chosen(reference, limits, rest, now);
    return command_;
  }

 private:
  static constexpr double largest_lag =
      0.5;  // of the tolerance: room for what the robot drives until both stand
  static constexpr int enough_samples = 10;       // until the noise is known to be small
  static constexpr double largest_yaw_lag = 0.3;  // radians: a robot that heads elsewhere leaves its line
  static constexpr double returns_from = 0.4;     // of the tolerance: before the reference waits

  DriveCommand chosen(const Twist& reference, const Limits& limits, const Rest& rest, WallTime now);
  DriveCommand glide(const Twist& reference, const Limits& limits) const;
  DriveCommand follow(const Twist& reference, const Limits& limits) const;
  DriveCommand come_to(double turning, const Limits& limits, const Rest& rest);
  DriveCommand drive_back(const Limits& limits) const;
  bool knows_error(double metres) const;
  bool knows_yaw_error(double radians) const;
  double turning_by(double angle, const Limits& limits) const;

  /// Of which a smoothed error is the mean, at most.
  struct Samples {
    double while_driving;
    double while_standing;
  };
  static Samples samples_of_error(const TrackingSettings& settings, double tolerance);
  static Samples samples_of_yaw_error(const TrackingSettings& settings);

  TrackingSettings settings_;
  double tolerance_;
  double farthest_;  ///< metres; a robot that is farther away is somewhere else
  Samples most_of_error_;
  Samples most_of_yaw_error_;
  std::optional<OdometrySample> last_{};
  int samples_ = 0;                ///< in a row
  Point2 error_ = Point2::Zero();  ///< reference minus robot, smoothed
  double yaw_error_ = 0;           ///< the same
  double of_error_ = 0;            ///< samples of which that is the mean
  double of_yaw_error_ = 0;
  double yaw_ = 0;            ///< of the robot, smoothed
  DriveCommand command_{};    ///< the last one
  WallTime away_at_ = 0;      ///< last
  bool lags_ = true;          ///< the reference waits
  bool comes_back_ = false;   ///< to its reference, which stands
  bool turns_along_ = false;  ///< to the yaw of its reference, which stands
};

}  // namespace coppice
