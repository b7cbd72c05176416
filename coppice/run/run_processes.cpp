#include "coppice/run/run_processes.h"

#include <functional>
#include <utility>

#include <fmt/format.h>

#include "coppice/run/local_fleets.h"
#include "dds/datagram.h"
#include "dds/discovery.h"
#include "dds/security.h"
#include "ros2/names.h"

namespace coppice {

namespace {

// The broker and the service get higher priority than the agents, because all agents need them.
constexpr int niceness_of_agents = 10;

using Command = std::vector<std::string>;

Command joined(Command command, const Command& more) {
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

/// The parameters of the trees that differ from the usual ones.
void add_trees(const RunOptions& options,
               const std::function<void(const std::string&, const std::string&)>& add) {
  const TreeParameters usual;
  const auto number = [&](const char* name, double value, double usual_value) {
    if (value != usual_value) add(name, fmt::format("{}", value));
  };
  number("--epsilon", options.trees.epsilon, usual.epsilon);
  number("--disjointed-trees", options.trees.disjointed_trees, usual.disjointed_trees);
  number("--kappa", options.trees.kappa, usual.kappa);
  number("--failure-factor", options.trees.failure_factor, usual.failure_factor);
  number("--restart-weight", options.trees.restart_weight, usual.restart_weight);
  number("--spacing", options.trees.spacing, usual.spacing);
  add("--restarts", options.restarts);
}

Command service_command(const RunOptions& options, const std::string& program) {
  Command command{program, options.scenario};
  const auto add = [&](const std::string& name, const std::string& value) {
    command.push_back(name);
    command.push_back(value);
  };
  if (!options.overrides.map.empty()) add("--map", options.overrides.map);
  if (options.overrides.robots) add("--robots", std::to_string(*options.overrides.robots));
  if (options.overrides.radius) add("--radius", fmt::format("{}", *options.overrides.radius));
  if (options.overrides.max_speed) add("--max-speed", fmt::format("{}", *options.overrides.max_speed));
  if (!options.overrides.kinematics.empty()) add("--kinematics", options.overrides.kinematics);
  if (options.overrides.margin) add("--margin", fmt::format("{}", *options.overrides.margin));
  if (options.overrides.seed) add("--seed", std::to_string(*options.overrides.seed));
  add("--time-scale", fmt::format("{}", options.time_scale.value()));
  if (!options.serves) add("--timeout", fmt::format("{}", options.timeout));
  if (!options.plan.empty()) add("--plan", options.plan);
  if (!options.report.empty()) add("--report", options.report);
  if (!options.trajectory.empty()) add("--trajectory", options.trajectory);
  if (!options.picture.empty()) add("--picture", options.picture);
  add("--planner", options.planner);
  add("--forest", options.forest);
  add("--coordination", options.coordination);
  if (options.rounds) add("--rounds", *options.rounds);
  add_trees(options, add);
  if (options.lifelong > 0) add("--lifelong", fmt::format("{}", options.lifelong));
  if (options.plan_budget) add("--plan-budget", fmt::format("{}", *options.plan_budget));
  if (options.serves) command.emplace_back("--serve");
  if (options.quiet) command.emplace_back("--quiet");
  return command;
}

/// By default, large fleets use static discovery.
std::string discovery_of(const FleetOptions& options, std::size_t robots) {
  const bool chosen = !options.discovery.empty() || !usual_discovery_servers().empty();
  return chosen || options.ros.on || std::cmp_less(robots, large_fleet) ? options.discovery
                                                                        : static_discovery;
}

/// The options by which the processes of a run, all on one host, find each other.
Command network_of(const FleetOptions& options, std::size_t robots) {
  const Command network{"--domain", std::to_string(options.domain.value())};
  const std::string discovery = discovery_of(options, robots);
  return discovery.empty() ? network : joined(network, {"--discovery", discovery});
}

/// The options for the log of each process.
Command log_of(const LogOptions& options) {
  Command log{"--log-level", options.level};
  if (options.json) log.emplace_back("--log-json");
  return log;
}

/// The options for ROS of each process that uses it.
Command ros_of(const RosOptions& options) {
  if (!options.on) return {};
  Command command{"--ros"};
  if (options.drives()) command = joined(std::move(command), {"--drive", "ros"});
  const RosNames& names = options.robot.names;
  return joined(std::move(command),
                {"--ros-namespace", names.robot_namespace, "--map-frame", names.map_frame});
}

/// Those of an agent as well.
Command ros_of_agent(const RosOptions& options) {
  if (!options.on) return {};
  const RosRobotSettings& robot = options.robot;
  Command command = joined(ros_of(options), {"--base-frame", robot.names.base_frame, "--odom-frame",
                                             robot.names.odom_frame, "--tf-topic", robot.names.tf});
  if (robot.stamped) command.emplace_back("--stamped");
  if (!options.drives()) return command;
  const char* const pose = robot.pose == PoseSource::odom        ? "odom"
                           : robot.pose == PoseSource::amcl_pose ? "amcl_pose"
                                                                 : "tf";
  return joined(std::move(command), {"--pose", pose, "--odom-timeout", fmt::format("{}", options.patience)});
}

/// The name cannot equal that of another process, whatever the robot's name is.
std::string name_of_agent(const RobotName& robot) {
  return "robot-" + robot;
}

}  // namespace

DdsSettings settings_of(const FleetOptions& options, std::size_t robots) {
  return {.domain = options.domain.value(),
          .discovery = discovery_of(options, robots),
          .largest_datagram = datagram_for_one_host,
          .security = options.security.empty() ? "" : options.security + "/observer"};
}

std::string watching_command(const FleetOptions& options, std::size_t robots) {
  Command command = joined({"coppice", "monitor"}, network_of(options, robots));
  // Another terminal need not have this variable.
  if (discovery_of(options, robots).empty() && !usual_discovery_servers().empty())
    command = joined(command, {"--discovery", usual_discovery_servers()});
  if (!options.security.empty()) command = joined(command, {"--security", options.security + "/observer"});
  return shell_words(command);
}

std::vector<Process> processes_of(const Scenario& scenario, const RunOptions& options,
                                  const FleetOptions& fleet, const std::filesystem::path& programs,
                                  const std::filesystem::path& state,
                                  const std::filesystem::path& black_boxes) {
  const Command all_are_told = joined(network_of(fleet, scenario.robots.size()), log_of(fleet.log));
  const auto on_network = [&](Command command, const std::string& role_name, Role role) {
    command[0] = (programs / command[0]).string();
    command = joined(std::move(command), all_are_told);
    if (fleet.security.empty()) return command;
    const std::string credentials = fleet.security + "/" + role_name;
    check_credentials(credentials, role);
    return joined(std::move(command), {"--security", credentials});
  };
  const auto with = [&](const Command& command, const std::string& role_name, Role role,
                        const std::filesystem::path& keeps_in) {
    const Command whole =
        joined(on_network(command, role_name, role), {"--datagram", std::to_string(datagram_for_one_host)});
    return state.empty() ? whole : joined(whole, {"--state", keeps_in.string()});
  };
  std::vector<Process> all;
  if (!fleet.record.file.empty()) {
    Command record{"coppice", "record", fleet.record.file};
    if (fleet.record.force) record.emplace_back("--force");
    all.push_back({recorder_name, on_network(record, "observer", Role::observer)});
  }
  if (fleet.watch)
    all.push_back({"monitor",
                   on_network({"coppice", "monitor", "--else-any-port", "--open"}, "observer", Role::viewer),
                   ProcessFleet::Output::terminal});
  const Command ros = ros_of(fleet.ros);
  const Command broker{"tree_broker", "--seed", std::to_string(scenario.seed)};
  all.push_back({"tree_broker", with(broker, "broker", Role::broker, state)});
  if (fleet.standby)
    all.push_back({"standby_broker", with(broker, "broker", Role::broker, state / "standby")});
  for (const RobotTask& robot : scenario.robots) {
    const Command agent = joined({"robot_agent", "--name", robot.name, "--black-boxes", black_boxes.string()},
                                 ros_of_agent(fleet.ros));
    all.push_back({.name = name_of_agent(robot.name),
                   .command = with(agent, "agent", Role::agent, state),
                   .niceness = niceness_of_agents});
  }
  Command service = joined(service_command(options, service_name), ros);
  service = joined(std::move(service), {"--black-boxes", black_boxes.string()});
  if (fleet.ros.tolerance)
    service = joined(std::move(service), {"--tracking-tolerance", fmt::format("{}", *fleet.ros.tolerance)});
  if (!fleet.start_at.empty()) service = joined(std::move(service), {"--start-at", fleet.start_at});
  all.push_back(
      {service_name, with(service, "service", Role::service, state), ProcessFleet::Output::terminal});
  return all;
}

}  // namespace coppice
