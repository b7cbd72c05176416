#include "runtime/process_options.h"

#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "dds/discovery.h"
#include "planning/whole_number.h"

namespace coppice {

namespace {

/// CLI11's own range reads 010 as 8.
CLI::Validator whole_number_in(int least, int most) {
  const std::string bounds = fmt::format("{} to {}", least, most);
  return {[=](std::string& text) {
            const auto number = whole_number(text, least, most);
            if (!number)
              return fmt::format("{} is not allowed, expected a whole number from {}", text, bounds);
            text = std::to_string(*number);
            return std::string();
          },
          bounds};
}

/// CLI11's own range accepts NaN.
CLI::Validator number_in(double least, double most) {
  const std::string bounds = fmt::format("{} to {}", least, most);
  return {[=](const std::string& text) {
            double value = 0;
            const bool fits = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return fits ? std::string()
                        : fmt::format("{} is not allowed, expected a number from {}", text, bounds);
          },
          bounds};
}

}  // namespace

CLI::Validator a_discovery() {
  const auto problem = [](const std::string& text) -> std::string {
    // Ports are from 1 to 65535.
    static const std::string server(
        "[^:;]+:0*([1-9][0-9]{0,3}|[1-5][0-9]{4}|6[0-4][0-9]{3}|65[0-4][0-9]{2}|655[0-2][0-9]|6553[0-5])");
    static const std::regex known("multicast|static|" + server + "(;" + server + ")*");
    if (std::regex_match(text, known)) return {};
    return text +
           " is not a way of discovery, expected multicast, static or HOST:PORT;..., with ports from 1 to "
           "65535";
  };
  return {problem, "multicast|static|HOST:PORT"};
}

CLI::Validator a_folder_name() {
  return {[](const std::string& text) {
            return text.empty() ? std::string("is empty, expected a folder: an unset variable?")
                                : std::string();
          },
          "FOLDER"};
}

CLI::Validator a_domain() {
  return whole_number_in(0, 232);
}

namespace {

CLI::Validator a_ros_name() {
  return {[](const std::string& text) {
            static const std::regex known("([A-Za-z_]|\\{\\})([A-Za-z0-9_/]|\\{\\})*");
            return text.empty() || (std::regex_match(text, known) && text.back() != '/')
                       ? std::string()
                       : text +
                             " is no name in ROS: expected letters, digits, _ and /, and {} for the "
                             "robot's name";
          },
          "NAME"};
}

void add_ros_names(CLI::App& app, RosNames& names, CLI::Option* ros, bool of_agents) {
  const auto add = [&](const char* option, std::string& name, const char* what) {
    app.add_option(option, name, what)->check(a_ros_name())->needs(ros);
  };
  add("--ros-namespace", names.robot_namespace, "namespace of a robot's topics; {}: its name");
  add("--map-frame", names.map_frame, "frame of the map");
  if (!of_agents) return;
  add("--base-frame", names.base_frame, "frame of a robot; {}: its name");
  add("--odom-frame", names.odom_frame, "frame of a robot's odometry; {}: its name");
  add("--tf-topic", names.tf, "topic of a robot's transforms; {}: its name");
}

}  // namespace

void add_ros_options(CLI::App& app, RosOptions& options, bool of_agents, bool of_service) {
  app.option_defaults()->group("ROS 2");
  CLI::Option* const ros =
      app.add_flag("--ros", options.on, "publishes topics of ROS 2 as well, for RViz and Nav2");
  CLI::Option* const drive =
      app.add_option_function<std::string>(
             "--drive",
             [&options](const std::string& who) {
               options.robot.pose = who == "ros" ? PoseSource::odom : PoseSource::none;
             },
             "virtual: Coppice moves the robots; ros: robots outside of Coppice follow cmd_vel and say where "
             "they are")
          ->check(CLI::IsMember({"virtual", "ros"}))
          ->needs(ros)
          ->default_str("virtual")
          ->trigger_on_parse();  // before --pose
  add_ros_names(app, options.robot.names, ros, of_agents);
  if (of_agents) {
    app.add_option_function<std::string>(
           "--pose",
           [&options](const std::string& source) {
             options.robot.pose = source == "odom"        ? PoseSource::odom
                                  : source == "amcl_pose" ? PoseSource::amcl_pose
                                                          : PoseSource::tf;
           },
           "where such a robot says where it is: odom (in the map's frame), amcl_pose, or tf")
        ->check(CLI::IsMember({"odom", "amcl_pose", "tf"}))
        ->needs(drive)
        ->default_str("odom");
    app.add_flag("--stamped", options.robot.stamped, "cmd_vel is a TwistStamped")->needs(ros);
    app.add_option("--odom-timeout", options.patience,
                   "seconds without odometry after which such a robot is stopped")
        ->check(number_in(0.05, 60.0))
        ->needs(drive);
  }
  if (of_service) {
    app.add_option("--tracking-tolerance", options.tolerance,
                   "margin of such robots, metres: how far a robot may be off its reference; less where "
                   "there is less room")
        ->check(number_in(1e-3, 1e3))
        ->needs(drive)
        ->default_str("what it drives in a quarter of a second, at most its radius");
  }
}

void check_ros(const RosOptions& options, const std::string& discovery, const std::string& security) {
  if (!options.on) return;
  if (!security.empty())
    throw std::runtime_error(
        "--ros goes without --security: programs of ROS 2 are not in the fleet's permissions");
  if (discovery == static_discovery)
    throw std::runtime_error(
        "--ros goes without --discovery static: programs of ROS 2 would not find the topics");
}

void add_log_options(CLI::App& app, LogOptions& options) {
  app.option_defaults()->group("Log");
  app.add_option("--log-level", options.level, "least severe level that is logged")
      ->check(CLI::IsMember(
          std::vector<std::string>{"trace", "debug", "info", "warning", "error", "critical", "off"}));
  app.add_flag("--log-json", options.json, "writes the log as lines of JSON");
}

void add_black_box_option(CLI::App& app, std::string& folder, const std::string& help) {
  app.option_defaults()->group("Supervision");
  app.add_option("--black-boxes", folder, help)->check(a_folder_name())->default_str("none");
}

void add_process_options(CLI::App& app, ProcessOptions& options) {
  app.option_defaults()->group("Network");
  app.add_option("--domain", options.network.domain, "DDS domain")->check(a_domain());
  app.add_option("--discovery", options.network.discovery,
                 "how processes find each other: multicast; static (multicast with a fixed table of "
                 "endpoints, for large "
                 "fleets); or discovery servers, separated by ;")
      ->check(a_discovery())
      ->default_str(default_discovery);
  app.add_option("--security", options.network.security,
                 "turns DDS-Security on: folder with this role's credentials")
      ->check(a_folder_name())
      ->default_str("off");
  app.add_option("--datagram", options.network.largest_datagram,
                 "largest UDP datagram, bytes: the default fits every network")
      ->check(whole_number_in(datagram_for_networks, datagram_for_one_host));
  app.option_defaults()->group("Supervision");
  app.add_option("--state", options.state, "folder for the state with which a restarted process continues")
      ->check(a_folder_name())
      ->default_str("nothing is kept");
  app.add_option("--alive", options.alive,
                 "file that is touched every second while the process works, for health checks")
      ->type_name("FILE")
      ->default_str("none");
  add_log_options(app, options.log);
}

}  // namespace coppice
