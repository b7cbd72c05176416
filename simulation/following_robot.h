// A simulated robot that follows its agent's commands as real robots do: late, with wheels that slip, seen by
// noisy odometry.
//
// Metres in the map frame, seconds, radians.
#pragma once

#include "coppice/files/scenario.h"
#include "coppice/motion/separation.h"
#include "coppice/planning/random.h"
#include "coppice/simulation/faults.h"
#include "robot_agent/control/tracking.h"
#include "robot_agent/process/reference_limits.h"

namespace coppice {

class FollowingRobot {
 public:
  /// Radians for each metre of noise: that of a position 1 m ahead of the robot.
  static constexpr double yaw_noise = 1;

  /// Stands at the start of its task. `time`: fleet time.
  FollowingRobot(const RobotTask& task, const DriveFaults& faults, double time, Random random);

  /// Drives on for a period towards a command. The motion is constant within the period, and within the
  /// robot's limits.
  void advance(const DriveCommand& command, double period);

  double time() const { return at_.time; }
  /// Where it is, and its motion in the period from then on.
  const TrackPoint& at() const { return at_; }
  /// Where it seems to be.
  OdometrySample odometry(WallTime now);

 private:
  Twist next(const DriveCommand& command, double period) const;
  double noise();

  Limits limits_;
  DriveFaults faults_;
  Random random_;
  double left_wheel_;  ///< share of its speed that is left by slip; for a holonomic robot the only one
  double right_wheel_;
  double half_track_;  ///< metres from the middle to a wheel
  TrackPoint at_;
};

}  // namespace coppice
