#include "simulation/drive_limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "coppice/files/scenario_file.h"
#include "robot_agent/process/reference_limits.h"
#include "simulation/fault_limits.h"
#include "simulation/following_robot.h"

namespace coppice {

namespace {

// A robot knows where it is and heads well enough to arrive (Run::its_robot_is_there), and to drive on.
constexpr double of_tolerance = 0.4;
constexpr double of_goal_tolerance = 0.75;
constexpr double of_yaw_tolerance = 2.0;
constexpr double most_yaw_noise = 0.3;  // radians

// That are tried in turn for a tolerance. With a smaller one a robot would hardly get on.
constexpr std::array shares_of_speed{1.0, 0.5, 0.25, 0.1, 0.05, 0.02};

// A robot that turns on the spot must not drift from where it came to rest to where it comes back from.
constexpr double of_tolerance_on_the_spot = 0.35;
constexpr double of_goal_tolerance_on_the_spot = 0.5;

Follower follower_of(const RobotTask& task) {
  return {limits_of(task), task.radius, task.tracking_tolerance};
}

bool keeps_within(const RobotTask& task, const DriveFaults& drive) {
  const Following following{.lag = drive.lag,
                            .slip = drive.slip,
                            .noise = drive.odometry_noise,
                            .yaw_noise = FollowingRobot::yaw_noise * drive.odometry_noise};
  const Follower robot = follower_of(task);
  return largest_reference_speed(robot, following) >= reference_limits(robot, 1).max_speed;
}

/// Noise neither moves the robot out of its tolerance nor hides that it has arrived.
bool sees_where_it_is(const RobotTask& task, double noise) {
  if (noise > std::min(of_tolerance * task.tracking_tolerance, of_goal_tolerance * task.goal_tolerance))
    return false;
  if (!is_differential(limits_of(task))) return true;
  const double yaw =
      task.goal_yaw_tolerance > 0 ? of_yaw_tolerance * task.goal_yaw_tolerance : most_yaw_noise;
  return FollowingRobot::yaw_noise * noise <= std::min(yaw, most_yaw_noise);
}

/// A robot one of whose wheels slips turns on the spot on a small circle.
bool turns_on_the_spot(const RobotTask& task, double slip) {
  const double drift = 2 * wheels_at * task.radius * unequal_wheels(slip);
  return !is_differential(limits_of(task)) ||
         (drift <= of_tolerance_on_the_spot * task.tracking_tolerance &&
          (task.goal_yaw_tolerance == 0 || drift <= of_goal_tolerance_on_the_spot * task.goal_tolerance));
}

bool bears(const RobotTask& task, const DriveFaults& drive) {
  return keeps_within(task, drive) && sees_where_it_is(task, drive.odometry_noise) &&
         turns_on_the_spot(task, drive.slip);
}

/// A drive with one of the faults alone.
DriveFaults only(double DriveFaults::*fault, double value) {
  DriveFaults drive;
  drive.*fault = value;
  return drive;
}

double largest_alone(const RobotTask& task, double DriveFaults::*fault, double limit) {
  return largest_kept(limit, [&](double value) { return bears(task, only(fault, value)); });
}

void check_kept(std::string_view what, std::string_view unit, double DriveFaults::*fault,
                const DriveFaults& drive, const Scenario& scenario) {
  const double value = drive.*fault;
  const auto bears_it = [&](const RobotTask& task) { return bears(task, only(fault, value)); };
  if (std::ranges::all_of(scenario.robots, bears_it)) return;
  const auto most = [&](const RobotTask& task) { return largest_alone(task, fault, value); };
  const RobotTask& robot = *std::ranges::min_element(scenario.robots, {}, most);
  throw InputError(fmt::format(
      "faults.drive.{}: {}{} takes {} out of its tracking tolerance of {:.3g} m, or it does not come "
      "to rest at its goal, expected at most {:.3g}{}",
      what, value, unit, robot.name, robot.tracking_tolerance, most(robot), unit));
}

/// The least tolerance from the usual one on with which the robot bears the drive, as fast as it can. The
/// usual one if none helps. One beyond the radius would leave fleets no room to pass each other.
double tolerance_for(RobotTask task, const DriveFaults& drive) {
  const double usual = usual_tolerance(task);
  const double most = task.radius;
  const auto bears_with = [&](double tolerance) {
    task.tracking_tolerance = tolerance;
    return bears(task, drive);
  };
  constexpr double rounding = 1e-6;
  for (const double speed = task.max_speed; const double share : shares_of_speed) {
    task.max_speed = share * speed;
    if (bears_with(usual)) return usual;
    if (!bears_with(most)) continue;
    const double less = largest_kept(most - usual, [&](double by) { return bears_with(most - by); });
    return most - less + rounding * usual;
  }
  return usual;
}

/// The largest speed with which the robot bears the drive. Its own one if it bears it with none.
double speed_for(RobotTask task, const DriveFaults& drive) {
  const double own = task.max_speed;
  const double speed = largest_kept(own, [&](double slower) {
    task.max_speed = slower;
    return bears(task, drive);
  });
  return speed >= shares_of_speed.back() * own ? speed : own;
}

}  // namespace

DriveFaults largest_drive_faults(const RobotTask& task) {
  return {.odometry_noise = largest_alone(task, &DriveFaults::odometry_noise, most_noise),
          .lag = largest_alone(task, &DriveFaults::lag, longest_lag),
          .slip = largest_alone(task, &DriveFaults::slip, most_slip)};
}

void check_drive(const DriveFaults& drive, const Scenario& scenario) {
  if (!is_any(drive)) return;
  for (const RobotTask& robot : scenario.robots) {
    if (robot.tracking_tolerance == 0)
      throw InputError(
          fmt::format("faults.drive: {} has no tracking_tolerance to be off its reference", robot.name));
  }
  check_kept("odometry_noise", " m", &DriveFaults::odometry_noise, drive, scenario);
  check_kept("lag", " s", &DriveFaults::lag, drive, scenario);
  check_kept("slip", "", &DriveFaults::slip, drive, scenario);
}

void fit_to_drive(const DriveFaults& drive, Scenario& scenario) {
  if (std::ranges::all_of(scenario.robots, [&](const RobotTask& robot) { return bears(robot, drive); }))
    return;
  std::vector<WishedTolerance> wished;
  for (const RobotTask& robot : scenario.robots)
    wished.push_back(
        {.most = tolerance_for(robot, drive), .least = least_share_of_tolerance * usual_tolerance(robot)});
  fit_tracking_tolerances(scenario, wished);
  for (RobotTask& robot : scenario.robots) robot.max_speed = speed_for(robot, drive);
  if (scenario.margin > 0) fit_margin(scenario, scenario.margin);
}

}  // namespace coppice
