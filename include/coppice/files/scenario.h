// The input of a run: a map, and a task for each robot. All defaults are filled in.
//
// Metres in the map frame, seconds, metres per second.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
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
inline constexpr double default_margin_radii = 0.1;
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
  /// Metres by which a robot that follows may be off its reference (robot_agent/control/tracking.h): the
  /// reference takes as much more room. 0 for a robot that Coppice moves itself.
  double tracking_tolerance = 0;
  /// Corners of the robot seen from above, metres in its own frame: x ahead, y to the side where the yaw
  /// grows. They lie within the radius, as the robot turns. Empty: a disc.
  std::vector<Point2> footprint{};
  /// Where the robot stands in the beginning, if that is too near to an obstacle by less than
  /// start_tolerance(): it drives to `start` first, which is free. None: it stands at `start`.
  std::optional<Point2> stands_at{};
};

/// Metres by which a robot may overlap obstacles in the beginning: nobody knows its place better than to its
/// tolerance. Half a radius is no error of a place any more.
inline double start_tolerance(double goal_tolerance, double radius) {
  return std::min(goal_tolerance, radius / 2);
}

/// Where the body that Coppice drives begins. A robot that follows it is driven to it.
inline Point2 body_begins_at(const RobotTask& task) {
  return task.tracking_tolerance > 0 ? task.start : task.stands_at.value_or(task.start);
}

inline Limits limits_of(const RobotTask& task) {
  return {task.max_speed, task.max_acceleration, task.max_angular_speed, task.max_angular_acceleration};
}

/// The radius with which the robot is planned.
inline double reference_radius(const RobotTask& task) {
  return task.radius + task.tracking_tolerance;
}

/// The radius that the robot needs where it drives.
inline double driving_radius(const RobotTask& task) {
  return driving_radius(reference_radius(task), limits_of(task));
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
  /// Metres that all robots keep from obstacles beyond their radius, and from each other where there is room.
  double margin = 0;
};

/// The radius of the disc that holds a footprint while the robot turns, metres. Throws InputError, which
/// names `field`, if it is no polygon that holds the robot's centre.
double radius_of_footprint(const std::vector<Point2>& footprint, const std::string& field);

/// Throws InputError, which names the field and what was expected, if the scenario is not as described here.
void check_scenario(const Scenario& scenario);

/// Gives the scenario the largest margin up to `wished` (metres) with which starts and goals have room, and
/// all passages stay open (planning/geometry/room_for_margin.h).
void fit_margin(Scenario& scenario, double wished);

/// Metres that a robot may be off its reference.
struct WishedTolerance {
  double most = 0;
  double least = 0;
};

/// Gives each robot the largest tolerance, up to the most that is wished for (by robot), with which its start
/// and goal have room and it has a way. Throws InputError if there is no room for the least one.
void fit_tracking_tolerances(Scenario& scenario, const std::vector<WishedTolerance>& wished);

inline std::vector<std::string> names_of(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const RobotTask& robot : scenario.robots) names.push_back(robot.name);
  return names;
}

}  // namespace coppice
