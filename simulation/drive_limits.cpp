#include "simulation/drive_limits.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "coppice/files/scenario_file.h"
#include "robot_agent/tracking.h"
#include "simulation/fault_limits.h"
#include "simulation/following_robot.h"

namespace coppice {

namespace {

// Shares of the tolerance that are for each fault. Noise seems to move a robot by 1.25 times its deviation,
// with smoothing and three deviations. So the sum is 0.9.
constexpr double for_lag = 1.0 / 3;
constexpr double for_slip = 1.0 / 3;
constexpr double for_noise = 0.185;
// Of the noise: the deviations of the error and the yaw that commands make up for.
constexpr double smoothed = 0.4;
constexpr double smoothed_yaw = 0.6;

// A robot knows where it is and heads well enough to arrive (Run::its_robot_is_there), and to drive on.
constexpr double of_goal_tolerance = 0.5;
constexpr double of_yaw_tolerance = 0.5;
constexpr double most_yaw_noise = 0.15;  // radians

// Of slip that turns a robot.
constexpr double of_angular_speed = 0.25;  // the rest is for turning along with the reference
constexpr double largest_heading = 0.3;    // radians, with which it steers against that
// A robot that turns on the spot must not drift from where it came to rest to where it comes back from.
constexpr double of_tolerance_on_the_spot = 0.2;
constexpr double of_goal_tolerance_on_the_spot = 0.25;

Limits reference_of(const RobotTask& task) {
  return Tracking::reference_limits(limits_of(task), task.tracking_tolerance, 1);
}

/// As commands correct the robot (Run::command).
Correction of_position(const RobotTask& task) {
  Limits limits = reference_of(task);
  limits.max_acceleration /= Tracking::share_of_acceleration;
  return Tracking::of_position(limits);
}

/// Corrections follow the noise. A holonomic robot is commanded in its own frame, and so drives aside by the
/// noise of its yaw. The commands of a differential robot have no such part.
double largest_noise(const RobotTask& task) {
  const Limits limits = limits_of(task);
  const double off = for_noise * task.tracking_tolerance;
  const double corrected = of_position(task).speed(off);
  const double most =
      std::min({off, corrected / smoothed, of_goal_tolerance * task.goal_tolerance, most_noise});
  if (!is_differential(limits)) {
    const double aside = smoothed_yaw * FollowingRobot::yaw_noise * reference_of(task).max_speed;
    return std::min(most, corrected / aside);
  }
  const double yaw =
      task.goal_yaw_tolerance > 0 ? of_yaw_tolerance * task.goal_yaw_tolerance : most_yaw_noise;
  return std::min(most, std::min(yaw, most_yaw_noise) / FollowingRobot::yaw_noise);
}

/// Commands make up for the usual lag. For the rest of it a robot goes on as before while its reference
/// drives otherwise: a holonomic one back, at most. If that takes long, corrections of one second keep it
/// closer.
double largest_lag(const RobotTask& task) {
  const Limits reference = reference_of(task);
  const double change = is_differential(reference) ? reference.max_speed : 2 * reference.max_speed;
  const double behind_in_a_second = std::min(change, reference.max_acceleration * 1.0);
  return std::min(Tracking::usual_lag + for_lag * task.tracking_tolerance / behind_in_a_second, longest_lag);
}

/// One wheel slips and the other does not: the robot turns. It turns on the spot on a small circle, and along
/// a straight way it stays so far beside its reference that it steers against its turning.
bool keeps_its_heading(const RobotTask& task, double slip) {
  const Limits limits = limits_of(task);
  const double speed = reference_of(task).max_speed;
  const double half_track = FollowingRobot::wheels_at * task.radius;
  const double unequal = slip / (2 - slip);
  const double drift = 2 * half_track * unequal;
  if (drift > of_tolerance_on_the_spot * task.tracking_tolerance) return false;
  if (task.goal_yaw_tolerance > 0 && drift > of_goal_tolerance_on_the_spot * task.goal_tolerance)
    return false;
  const double turning = speed / half_track * unequal;
  if (turning > of_angular_speed * task.max_angular_speed) return false;
  const double heading = Tracking::of_yaw(limits).error(turning);
  if (heading > largest_heading) return false;
  const double aside = std::tan(heading) * (1 + Tracking::slow / Tracking::share_of_speed) * speed;
  return of_position(task).error(aside) <= for_slip * task.tracking_tolerance;
}

/// A robot that is slower by its slip is behind until it makes up for that.
bool keeps_up(const RobotTask& task, double slip) {
  const double missing = slip / (1 - slip) * reference_of(task).max_speed;
  return of_position(task).error(missing) <= for_slip * task.tracking_tolerance;
}

/// The largest value up to `most` that is kept, if smaller ones are.
template <class Kept>
double largest(double most, Kept&& kept) {
  double least = 0;
  for (int k = 0; k < 40; ++k) {
    const double middle = (least + most) / 2;
    (kept(middle) ? least : most) = middle;
  }
  return least;
}

double largest_slip(const RobotTask& task) {
  return largest(most_slip, [&](double slip) {
    return keeps_up(task, slip) && (!is_differential(limits_of(task)) || keeps_its_heading(task, slip));
  });
}

bool bears(const RobotTask& task, const DriveFaults& drive) {
  const DriveFaults most = largest_drive_faults(task);
  return drive.odometry_noise <= most.odometry_noise && drive.lag <= most.lag && drive.slip <= most.slip;
}

void check_kept(std::string_view what, std::string_view unit, double DriveFaults::*fault,
                const DriveFaults& drive, const Scenario& scenario) {
  const auto most = [&](const RobotTask& task) { return largest_drive_faults(task).*fault; };
  const RobotTask& robot = *std::ranges::min_element(scenario.robots, {}, most);
  if (drive.*fault <= most(robot)) return;
  throw InputError(fmt::format(
      "faults.drive.{}: {}{} takes {} out of its tracking tolerance of {:.3g} m, expected at most {:.3g}{}",
      what, drive.*fault, unit, robot.name, robot.tracking_tolerance, most(robot), unit));
}

/// The least tolerance from the usual one on with which the robot bears the drive. The usual one if none
/// helps.
double tolerance_for(RobotTask task, const DriveFaults& drive) {
  constexpr double most_times = 8;
  const double usual = tracking_time * task.max_speed;
  const auto bears_with = [&](double times) {
    task.tracking_tolerance = times * usual;
    return bears(task, drive);
  };
  if (bears_with(1) || !bears_with(most_times)) return usual;
  constexpr double rounding = 1e-6;
  return (most_times - largest(most_times - 1, [&](double less) { return bears_with(most_times - less); }) +
          rounding) *
         usual;
}

}  // namespace

DriveFaults largest_drive_faults(const RobotTask& task) {
  return {largest_noise(task), largest_lag(task), largest_slip(task)};
}

void check_drive(const DriveFaults& drive, const Scenario& scenario) {
  if (!is_any(drive)) return;
  for (const RobotTask& robot : scenario.robots) {
    if (robot.tracking_tolerance == 0)
      throw InputError(
          fmt::format("faults.drive: {} has no tracking_tolerance to be off its reference", robot.name));
    if (robot.max_angular_speed > longest_spin_up * robot.max_angular_acceleration)
      throw InputError(fmt::format(
          "faults.drive: {} takes {:.3g} s to turn at its max_angular_speed, expected at most {} s to follow",
          robot.name, robot.max_angular_speed / robot.max_angular_acceleration, longest_spin_up));
  }
  check_kept("odometry_noise", " m", &DriveFaults::odometry_noise, drive, scenario);
  check_kept("lag", " s", &DriveFaults::lag, drive, scenario);
  check_kept("slip", "", &DriveFaults::slip, drive, scenario);
}

void widen_tolerances(const DriveFaults& drive, Scenario& scenario) {
  if (std::ranges::all_of(scenario.robots, [&](const RobotTask& robot) { return bears(robot, drive); }))
    return;
  std::vector<double> wished;
  for (const RobotTask& robot : scenario.robots) wished.push_back(tolerance_for(robot, drive));
  fit_tracking_tolerances(scenario, wished);
  if (scenario.margin > 0) fit_margin(scenario, scenario.margin);
}

}  // namespace coppice
