// The options common to all processes of a fleet.
#pragma once

#include <optional>
#include <string>

#include "dds/dds_bus.h"
#include "ros2/names.h"

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace coppice {

/// Log level and format (runtime/process.h).
struct LogOptions {
  std::string level = "info";
  bool json = false;
};

/// The folder of the boxes in which agents leave the ends of their tracks (runtime/black_box.h); empty: none.
/// `help`: what the process does with them.
void add_black_box_option(CLI::App& app, std::string& folder, const std::string& help);

struct ProcessOptions {
  DdsSettings network;
  std::string state;  ///< folder for the state that a successor needs; empty: nothing is kept
  std::string alive;  ///< file that is touched every second; empty: none
  LogOptions log;
};

/// A fleet's use of ROS 2 (docs/ros.md).
struct RosOptions {
  bool on = false;
  RosRobotSettings robot{};
  std::optional<double> tolerance{};  ///< metres by which such a robot may be off its reference: its margin
  double patience = 0.5;              ///< seconds without odometry after which such a robot is stopped

  /// The robots are outside of Coppice, and driven through ROS.
  bool drives() const { return robot.pose != PoseSource::none; }
};

/// Adds --ros and the options that go with it. `of_agents`, `of_service`: adds the options that only concern
/// these, too.
void add_ros_options(CLI::App& app, RosOptions& options, bool of_agents, bool of_service);

/// Throws std::runtime_error if the settings exclude programs of ROS.
void check_ros(const RosOptions& options, const std::string& discovery, const std::string& security);

/// Checks an option that names a DDS domain.
CLI::Validator a_domain();
/// Checks an option that says how processes find each other (DdsSettings::discovery).
CLI::Validator a_discovery();
/// The default of that option, as text for the help.
inline constexpr const char* default_discovery =
    "the servers of ROS_DISCOVERY_SERVER, or multicast, or with --security static";
/// Checks an option that names a folder: not empty, as the value of an unset variable would be.
CLI::Validator a_folder_name();

/// Adds --log-level and --log-json.
void add_log_options(CLI::App& app, LogOptions& options);

/// Adds the options of a process. Values out of range are usage errors.
void add_process_options(CLI::App& app, ProcessOptions& options);

}  // namespace coppice
