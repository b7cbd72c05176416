#include "coppice/files/scenario.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "coppice/files/map_file.h"
#include "coppice/planning/clearance_field.h"
#include "files/robot_starts.h"
#include "files/size_check.h"
#include "planning/number_text.h"
#include "planning/quantities.h"
#include "planning/robot_name.h"

namespace coppice {

namespace {

[[noreturn]] void fail(const std::string& field, const std::string& problem) {
  throw InputError(fmt::format("{}: {}", field, problem));
}

/// The beginning of a name that may hold anything.
std::string printable(const std::string& name) {
  std::string text = name.substr(0, longest_robot_name);
  std::ranges::replace_if(
      text, [](char c) { return c < ' ' || c == 127; }, '?');
  return text;
}

void check_name(const std::string& name, std::set<std::string>& names, const std::string& field) {
  if (!is_robot_name(name))
    fail(field, fmt::format("\"{}\" is not a name, expected {}", printable(name), robot_name_rule));
  if (!names.insert(name).second) fail(field, fmt::format("\"{}\" is also the name of another robot", name));
}

void check_yaw(double yaw, const std::string& field) {
  if (!is_yaw(yaw)) fail(field, fmt::format("{:g} is not allowed, expected {}", yaw, yaw_rule));
}

void check_angles(const RobotTask& robot, const std::string& at) {
  check_size(robot.max_angular_speed, at + ".max_angular_speed");
  check_size(robot.max_angular_acceleration, at + ".max_angular_acceleration");
  if (robot.max_angular_speed > fastest_turning) {
    fail(at + ".max_angular_speed",
         fmt::format("{} turns by more than half a turn in a control period, expected at most {:.2f}",
                     robot.max_angular_speed, fastest_turning));
  }
  if (!can_brake(robot.max_angular_speed, robot.max_angular_acceleration)) {
    fail(at + ".max_angular_acceleration",
         fmt::format("{} takes longer than {} s to come to rest from {}, expected at least {}",
                     robot.max_angular_acceleration, longest_braking, robot.max_angular_speed,
                     robot.max_angular_speed / longest_braking));
  }
  check_yaw(robot.start_yaw, at + ".start.yaw");
  check_yaw(robot.goal_yaw, at + ".goal.yaw");
}

void check_robot(const RobotTask& robot, const ClearanceField& field, const std::string& at) {
  check_size(robot.radius, at + ".radius");
  check_size(robot.max_speed, at + ".max_speed");
  check_size(robot.max_acceleration, at + ".max_acceleration");
  check_size(robot.goal_tolerance, at + ".goal_tolerance");
  if (!can_brake(robot.max_speed, robot.max_acceleration)) {
    fail(at + ".max_acceleration",
         fmt::format("{} takes longer than {} s to brake from {}, expected at least {}",
                     robot.max_acceleration, longest_braking, robot.max_speed,
                     robot.max_speed / longest_braking));
  }
  if (is_differential(limits_of(robot))) check_angles(robot, at);
  if (!(robot.tracking_tolerance >= 0 && is_sane(robot.tracking_tolerance)))
    fail(at + ".tracking_tolerance",
         fmt::format("{} is not allowed, expected a number from 0", robot.tracking_tolerance));
  if (!robot.footprint.empty()) {
    const double needed = radius_of_footprint(robot.footprint, at + ".footprint");
    if (robot.radius < needed)
      fail(at + ".radius",
           fmt::format("{} does not hold the footprint, expected at least {:.6g}", robot.radius, needed));
  }
  check_place(robot.start, field, driving_radius(robot), at + ".start");
  check_place(robot.goal, field, driving_radius(robot), at + ".goal");
}

double distance_at_goals(const RobotTask& one, const RobotTask& other) {
  return (one.goal - other.goal).norm();
}

void check_apart(const std::vector<RobotTask>& robots, double (*apart_at)(const RobotTask&, const RobotTask&),
                 const char* what) {
  for (std::size_t i = 0; i < robots.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = apart_at(robots[i], robots[j]);
      const double radii = reference_radius(robots[i]) + reference_radius(robots[j]);
      if (distance >= radii) continue;
      const auto [apart, needed] = told_apart(distance, radii);
      fail(fmt::format("robots[{}].{}", i, what),
           fmt::format("{} and {} would overlap there: distance {}, sum of their radii {}", robots[i].name,
                       robots[j].name, apart, needed));
    }
  }
}

}  // namespace

void check_size(double value, const std::string& field) {
  if (is_sane_size(value)) return;
  fail(field, fmt::format("{} is not allowed, expected a number above 0, from {} to {}", value,
                          least_quantity, largest_quantity));
}

void check_scenario(const Scenario& scenario) {
  try {
    check_map(scenario.map);
  } catch (const InputError& problem) {
    fail("map", problem.what());
  }
  if (scenario.robots.empty()) fail("robots", "is empty, expected at least one robot");
  // An agent has a table of at most `most_robots` robots and would ignore any further ones.
  if (std::cmp_greater(scenario.robots.size(), most_robots))
    fail("robots", fmt::format("{}, expected at most {}", scenario.robots.size(), most_robots));
  if (!(scenario.margin >= 0 && is_sane(scenario.margin)))
    fail("margin", fmt::format("{} is not allowed, expected a number from 0", scenario.margin));
  const ClearanceField field(scenario.map, scenario.margin);
  std::set<std::string> names;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const std::string at = fmt::format("robots[{}]", i);
    check_name(scenario.robots[i].name, names, at + ".name");
    check_robot(scenario.robots[i], field, at);
  }
  check_apart(scenario.robots, distance_at_starts, "start");
  check_apart(scenario.robots, distance_at_goals, "goal");
}

}  // namespace coppice
