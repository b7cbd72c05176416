// The input of a run: a map, and a task for each robot. All defaults are filled in.
//
// Metres in the map frame, seconds, metres per second.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coppice/motion/kinematics.h"
#include "coppice/planning/geometry.h"
#include "coppice/planning/occupancy_map.h"

namespace coppice {

// Defaults in cells of the map, so that they suit maps of any resolution.
inline constexpr double default_radius_cells = 5;
inline constexpr double default_speed_cells = 20;  // cells per second
inline constexpr double default_tolerance_cells = 1;
inline constexpr double default_yaw_tolerance = 0.1;  // radians
/// Default acceleration, m/s²: full speed within 0.5 s.
inline double usual_acceleration(double max_speed) {
  return 2 * max_speed;
}

struct RobotTask {
  std::string name;
  Point2 start = Point2::Zero();
  Point2 goal = Point2::Zero();
  double radius = 0;            ///< above 0
  double max_speed = 0;         ///< above 0
  double max_acceleration = 0;  ///< above 0
  double goal_tolerance = 0;    ///< above 0
  /// Radians a second, of a differential robot (coppice/motion/kinematics.h). 0: a holonomic robot.
  double max_angular_speed = 0;
  double max_angular_acceleration = 0;  ///< above 0 for a differential robot
  double start_yaw = 0;                 ///< radians, of a differential robot, like the next two
  double goal_yaw = 0;                  ///< where it is to head in the end
  double goal_yaw_tolerance = 0;        ///< 0: it may head anywhere
};

inline Limits limits_of(const RobotTask& task) {
  return {task.max_speed, task.max_acceleration, task.max_angular_speed, task.max_angular_acceleration};
}

/// The radius that the robot needs where it drives. A differential robot is beside its chords on its arcs.
inline double driving_radius(const RobotTask& task) {
  return task.radius + off_the_chord(limits_of(task), control_period);
}

/// A robot with the defaults on this map.
inline RobotTask robot_on(const OccupancyMap& map) {
  return {.radius = default_radius_cells * map.resolution,
          .max_speed = default_speed_cells * map.resolution,
          .max_acceleration = usual_acceleration(default_speed_cells * map.resolution),
          .goal_tolerance = default_tolerance_cells * map.resolution};
}

struct Scenario {
  std::string map_name;    ///< as the scenario or the command line names it
  std::string map_file{};  ///< relative to the working folder; empty: the map has no file
  OccupancyMap map;
  std::uint32_t seed = 1;
  /// At least one; names are unique; starts and goals are free and do not overlap.
  std::vector<RobotTask> robots;
};

/// Throws InputError, which names the field and what was expected, if the scenario is not as described here.
void check_scenario(const Scenario& scenario);

/// Throws InputError if a robot is differential. `option`: of the command line, which needs holonomic robots.
void check_holonomic(const Scenario& scenario, const std::string& option);

inline std::vector<std::string> names_of(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const RobotTask& robot : scenario.robots) names.push_back(robot.name);
  return names;
}

}  // namespace coppice
