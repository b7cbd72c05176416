// A scenario with every default filled in and every check passed: what a run is made from.
//
// Metres in the map frame, seconds, metres per second.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "planning/geometry.h"
#include "planning/occupancy_map.h"

namespace coppice {

// Defaults in cells of the map, so that they suit a map in metres as well as one in centimetres.
inline constexpr double default_radius_cells = 5;
inline constexpr double default_speed_cells = 20;  // a second
inline constexpr double default_tolerance_cells = 1;

struct RobotTask {
  std::string name;
  Point2 start = Point2::Zero();
  Point2 goal = Point2::Zero();
  double radius = 0;            ///< above 0
  double max_speed = 0;         ///< above 0
  double max_acceleration = 0;  ///< above 0
  double goal_tolerance = 0;    ///< above 0
};

struct Scenario {
  std::string map_name;    ///< as the scenario, or the command line, names it
  std::string map_file{};  ///< relative to the working folder; empty: of no file
  OccupancyMap map;
  std::uint32_t seed = 1;
  std::vector<RobotTask> robots;  ///< at least one; names differ; starts and goals are free and apart
};

inline std::vector<std::string> names_of(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const RobotTask& robot : scenario.robots) names.push_back(robot.name);
  return names;
}

}  // namespace coppice
