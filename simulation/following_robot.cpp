#include "simulation/following_robot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "motion/body/differential_drive.h"

namespace coppice {

namespace {

constexpr double standstill = 1e-6;  // metres and radians a second: a drive does not turn more slowly

/// A lag alone never comes to an end.
Twist at_rest_if_slow(Twist twist) {
  if (twist.velocity.norm() < standstill) twist.velocity.setZero();
  if (std::abs(twist.angular_velocity) < standstill) twist.angular_velocity = 0;
  return twist;
}

}  // namespace

FollowingRobot::FollowingRobot(const RobotTask& task, const DriveFaults& faults, double time, Random random)
    : limits_(limits_of(task)),
      faults_(faults),
      random_(random),
      left_wheel_(1 - random_.uniform(0, faults.slip)),
      right_wheel_(1 - random_.uniform(0, faults.slip)),
      half_track_(wheels_at * task.radius),
      at_{time, task.stands_at.value_or(task.start), Point2::Zero(), task.start_yaw, 0} {}

/// The drive comes closer to the command with the time constant of its lag.
Twist FollowingRobot::next(const DriveCommand& command, double period) const {
  const double share = faults_.lag > 0 ? 1 - std::exp(-period / faults_.lag) : 1;
  if (!is_differential(limits_)) {
    const Point2 wanted = left_wheel_ * rotated(command.linear, at_.yaw);
    return {within_limits(at_.velocity + share * (wanted - at_.velocity), at_.velocity, limits_, period), 0};
  }
  const double left = left_wheel_ * (command.linear.x() - half_track_ * command.angular);
  const double right = right_wheel_ * (command.linear.x() + half_track_ * command.angular);
  const double speed = at_.velocity.norm();
  const double change = limits_.max_angular_acceleration * period;
  const double wanted = (right - left) / (2 * half_track_);
  const double turning =
      at_.angular_velocity + std::clamp(share * (wanted - at_.angular_velocity), -change, change);
  return feasible_twist(speed + share * ((left + right) / 2 - speed),
                        std::clamp(turning, -limits_.max_angular_speed, limits_.max_angular_speed),
                        {at_.velocity, at_.angular_velocity}, at_.yaw, limits_, period);
}

void FollowingRobot::advance(const DriveCommand& command, double period) {
  at_.time += period;
  at_.position += period * at_.velocity;
  at_.yaw = wrapped(at_.yaw + period * at_.angular_velocity);
  const Twist twist = at_rest_if_slow(next(command, period));
  at_.velocity = twist.velocity;
  at_.angular_velocity = twist.angular_velocity;
}

/// Gaussian (Box, Muller, "A Note on the Generation of Random Normal Deviates", 1958).
double FollowingRobot::noise() {
  const double far = std::sqrt(-2 * std::log(1 - random_.uniform(0, 1)));
  return faults_.odometry_noise * far * std::cos(2 * std::numbers::pi * random_.uniform(0, 1));
}

OdometrySample FollowingRobot::odometry(WallTime now) {
  const double aside = noise();  // in turn: the order of arguments is the compiler's
  const double ahead = noise();
  return {.at = now,
          .position = at_.position + Point2(ahead, aside),
          .velocity = at_.velocity,
          .yaw = wrapped(at_.yaw + yaw_noise * noise()),
          .angular_velocity = at_.angular_velocity};
}

}  // namespace coppice
