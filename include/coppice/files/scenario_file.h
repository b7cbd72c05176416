// Scenario files: JSON (idl/scenario.proto) and Moving AI `.scen`. Metres, seconds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "coppice/files/map_file.h"
#include "coppice/files/scenario.h"

namespace coppice {

/// Seconds. A robot that follows its reference is off it by about its lag.
inline constexpr double tracking_time = 0.25;
/// Metres that a robot that follows may be off its reference, by default. More than its radius would leave
/// fleets of fast robots no room to pass each other.
inline double usual_tolerance(const RobotTask& robot) {
  return std::min(tracking_time * robot.max_speed, robot.radius);
}
/// Metres from its goal within which a robot that follows has arrived, by default: one cell would be less
/// than the noise of many poses. 0.25 m is usual (Nav2), and a small robot is to be more exact.
inline double usual_goal_tolerance(const RobotTask& robot, double cell) {
  return std::max(default_tolerance_cells * cell, std::min(0.25, robot.radius));
}
/// Share of the tolerance that is wished for: a robot with less room is refused.
inline constexpr double least_share_of_tolerance = 0.1;

/// Settings of the command line. They override those of the scenario file.
struct ScenarioOptions {
  std::optional<int> robots{};  ///< only the first so many robots
  std::optional<double> radius{};
  std::optional<double> max_speed{};
  std::optional<std::uint32_t> seed{};
  /// The map's file, relative to the working folder; empty: the file that the scenario names.
  std::string map{};
  MapWarnings warnings = MapWarnings::logged;
  std::string kinematics{};        ///< holonomic or differential, of every robot; empty: as the scenario says
  std::optional<double> margin{};  ///< metres; none: the scenario's, or a tenth of the least radius
  bool follow = false;             ///< the robots follow references (robot_agent/control/tracking.h)
  /// Metres, of robots that follow. None: what a robot drives in a quarter of a second.
  std::optional<double> tracking_tolerance{};
  bool is_site = false;  ///< robots may have no goals: they stay where they start until they get orders
};

/// Reads a scenario and its map, fills in defaults, and checks all that a run relies on. Robots of a `.scen`
/// file stand at the centres of their cells and are named r1, r2, ... Throws InputError, which names the
/// file, the line or field, and what was expected.
Scenario read_scenario(const std::filesystem::path& path, const ScenarioOptions& options);

/// Writes a scenario as JSON. `map_name` is the map's path relative to the file. Throws InputError if the
/// file cannot be written.
void write_scenario(const std::filesystem::path& path, const Scenario& scenario);

}  // namespace coppice
