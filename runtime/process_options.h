// The options that all processes of a fleet have.
#pragma once

#include <string>

#include "dds/dds_bus.h"

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace coppice {

/// What is logged, and how (runtime/process.h).
struct LogOptions {
  std::string level = "info";
  bool json = false;
};

struct ProcessOptions {
  DdsSettings network;
  std::string state;  ///< folder for what it keeps for its successor; empty: nothing is kept
  std::string alive;  ///< file that is touched every second; empty: none
  LogOptions log;
};

/// What a fleet does in ROS 2 (docs/ros.md).
struct RosOptions {
  bool on = false;
  bool drives = false;    ///< the robots are elsewhere, and told by ROS where to go
  double tolerance = 1;   ///< metres that such a robot may be off its reference
  double patience = 0.5;  ///< seconds without its odometry
  bool waits_for_goals = false;
};

/// --ros and what goes with it. `of_agents`, `of_service`: whether what concerns these alone is asked for,
/// too.
void add_ros_options(CLI::App& app, RosOptions& options, bool of_agents, bool of_service);

/// Throws std::runtime_error where programs of ROS could not take part.
void check_ros(const RosOptions& options, const std::string& discovery, const std::string& security);

/// Of an option that names a DDS domain.
CLI::Validator a_domain();
/// Of an option that says how processes find each other (DdsSettings::discovery).
CLI::Validator a_discovery();
/// What holds without that option, for people.
inline constexpr const char* default_discovery =
    "the servers of ROS_DISCOVERY_SERVER, or multicast, or with --security static";
/// Of an option that names a folder: not empty, as of a variable that is not set.
CLI::Validator a_folder_name();

/// --log-level and --log-json.
void add_log_options(CLI::App& app, LogOptions& options);

/// Values out of range are usage errors.
void add_process_options(CLI::App& app, ProcessOptions& options);

}  // namespace coppice
