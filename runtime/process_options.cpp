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

/// CLI11's own range takes 010 for 8.
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

/// CLI11's own range lets NaN pass.
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
           " is no way to find others, expected multicast, static or HOST:PORT;..., with ports from 1 to "
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

void add_ros_options(CLI::App& app, RosOptions& options, bool of_agents, bool of_service) {
  app.option_defaults()->group("ROS 2");
  CLI::Option* const ros =
      app.add_flag("--ros", options.on, "speaks ROS 2 as well: topics for RViz and Nav2");
  CLI::Option* const drive =
      app.add_option_function<std::string>(
             "--drive", [&options](const std::string& who) { options.drives = who == "ros"; },
             "virtual: robots are where Coppice drives them; ros: robots elsewhere follow cmd_vel and tell "
             "odom")
          ->check(CLI::IsMember({"virtual", "ros"}))
          ->needs(ros)
          ->default_str("virtual");
  app.add_option("--tracking-tolerance", options.tolerance,
                 "metres that such a robot may be off where it should be: all keep that much more room")
      ->check(number_in(1e-3, 1e3))
      ->needs(drive);
  if (of_agents) {
    app.add_option("--odom-timeout", options.patience,
                   "seconds without odometry until such a robot is stopped")
        ->check(number_in(0.05, 60.0))
        ->needs(drive);
  }
  if (of_service) {
    app.add_flag("--serve", options.waits_for_goals,
                 "goes on when all have arrived, and waits for goals until it is told to stop")
        ->needs(ros)
        ->excludes("--timeout");
  }
}

void check_ros(const RosOptions& options, const std::string& discovery, const std::string& security) {
  if (!options.on) return;
  if (!security.empty())
    throw std::runtime_error(
        "--ros goes without --security: programs of ROS 2 have no part in the fleet's permissions");
  if (discovery == static_discovery)
    throw std::runtime_error(
        "--ros goes without --discovery static: programs of ROS 2 would see none of the topics");
}

void add_log_options(CLI::App& app, LogOptions& options) {
  app.option_defaults()->group("Log");
  app.add_option("--log-level", options.level, "least important lines that are logged")
      ->check(CLI::IsMember(
          std::vector<std::string>{"trace", "debug", "info", "warning", "error", "critical", "off"}));
  app.add_flag("--log-json", options.json, "log lines of JSON");
}

void add_process_options(CLI::App& app, ProcessOptions& options) {
  app.option_defaults()->group("Network");
  app.add_option("--domain", options.network.domain, "DDS domain")->check(a_domain());
  app.add_option("--discovery", options.network.discovery,
                 "how processes find each other: multicast; static (by multicast, and a table of their "
                 "endpoints: for large fleets); or discovery servers, several with ; between them")
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
  app.add_option("--state", options.state,
                 "folder in which it keeps what it needs to go on if it is started anew")
      ->check(a_folder_name())
      ->default_str("nothing is kept");
  app.add_option("--alive", options.alive,
                 "file that is touched every second while all is well: for health checks")
      ->type_name("FILE")
      ->default_str("none");
  add_log_options(app, options.log);
}

}  // namespace coppice
