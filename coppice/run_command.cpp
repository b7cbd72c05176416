#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <span>
#include <thread>

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus/dds_bus.h"
#include "bus/dds_security.h"
#include "bus/process.h"
#include "coppice/commands.h"
#include "coppice/process_fleet.h"
#include "files/report_file.h"
#include "files/scenario_file.h"

namespace coppice {

namespace {

constexpr std::size_t large_fleet = 40;  // robots
// All agents need what the broker and the service do; these come first where all share few processors.
constexpr int niceness_of_agents = 10;
constexpr std::chrono::milliseconds grace{3000};
constexpr std::chrono::milliseconds poll_period{10};
constexpr std::chrono::seconds patience{15};  // for the report after Ctrl-C

/// A folder of its own for logs and the report, removed at the end.
class RunFolder {
 public:
  RunFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "coppice-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder can be made");
    path_ = name;
  }
  ~RunFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Whether no process of this machine has joined the DDS domain: each participant listens at the domain's
/// multicast port (DDS-RTPS 2.2, 9.6.1.1: 7400 + 250 d), which they share among themselves, but not with us.
bool is_unused(int domain) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * domain));
  const bool unused = bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(socket);
  return unused;
}

/// A domain of our own, so that two runs on one machine do not meet: up to 100 the default ports stay below
/// those that Linux hands out to others. Where to begin follows from the process, as another run may be
/// looking just now.
int own_domain() {
  constexpr int domains = 100;
  const int first = static_cast<int>(getpid()) % domains;
  for (int i = 0; i < domains; ++i) {
    const int domain = 1 + (first + i) % domains;
    if (is_unused(domain)) return domain;
  }
  throw std::runtime_error("every DDS domain from 1 to 100 is in use on this machine; name one by --domain");
}

std::vector<std::string> service_command(const RunOptions& options, const std::string& program,
                                         std::span<const std::string> network) {
  std::vector<std::string> command{program, options.scenario};
  command.insert(command.end(), network.begin(), network.end());
  const auto add = [&](const std::string& name, const std::string& value) {
    command.push_back(name);
    command.push_back(value);
  };
  if (options.overrides.robots) add("--robots", std::to_string(*options.overrides.robots));
  if (options.overrides.radius) add("--radius", fmt::format("{}", *options.overrides.radius));
  if (options.overrides.max_speed) add("--max-speed", fmt::format("{}", *options.overrides.max_speed));
  if (options.overrides.seed) add("--seed", std::to_string(*options.overrides.seed));
  add("--time-scale", fmt::format("{}", options.time_scale));
  add("--timeout", fmt::format("{}", options.timeout));
  if (!options.report.empty()) add("--report", options.report);
  if (!options.trajectory.empty()) add("--trajectory", options.trajectory);
  if (!options.picture.empty()) add("--picture", options.picture);
  add("--planner", options.planner);
  if (options.lifelong > 0) add("--lifelong", fmt::format("{}", options.lifelong));
  if (options.plan_budget) add("--plan-budget", fmt::format("{}", *options.plan_budget));
  if (options.quiet) command.emplace_back("--quiet");
  return command;
}

/// Where nothing else is asked for, large fleets find each other in the way that suits them.
std::string discovery_of(const RunOptions& options, std::size_t robots) {
  const bool chosen = !options.discovery.empty() || std::getenv("ROS_DISCOVERY_SERVER") != nullptr;
  return chosen || robots < large_fleet ? options.discovery : static_discovery;
}

/// The options that give a child its role's credentials. Bad ones are told of before anything starts.
std::vector<std::string> credentials(const RunOptions& options, const std::string& name, Role role) {
  if (options.security.empty()) return {};
  const std::string folder = options.security + "/" + name;
  check_credentials(folder, role);
  return {"--security", folder};
}

void tell_of_end(const ProcessFleet::Ended& ended) {
  std::cerr << fmt::format("{} ended early, exit code {}{}{}\n", ended.name, ended.exit_code,
                           ended.last_words.empty() ? "" : ": ", ended.last_words);
}

}  // namespace

int run_command(const RunOptions& options, const std::string& program) {
  const Scenario scenario =
      read_scenario(options.scenario, options.overrides);  // bad input: before anything starts
  install_stop_signals();
  const std::filesystem::path folder = std::filesystem::canonical(program).parent_path();
  const int domain = options.domain.value_or(own_domain());
  std::vector<std::string> network{"--domain", std::to_string(domain)};
  const std::string discovery = discovery_of(options, scenario.robots.size());
  if (!discovery.empty()) network.insert(network.end(), {"--discovery", discovery});
  const std::vector<std::string> of_broker = credentials(options, "broker", Role::broker);
  const std::vector<std::string> of_agent = credentials(options, "agent", Role::agent);
  const std::vector<std::string> of_service = credentials(options, "service", Role::service);
  const RunFolder run_folder;
  ProcessFleet fleet(run_folder.path());

  const auto start = [&](const std::string& name, std::vector<std::string> command,
                         const std::vector<std::string>& security, int niceness) {
    command.insert(command.end(), network.begin(), network.end());
    command.insert(command.end(), security.begin(), security.end());
    fleet.start(name, command, ProcessFleet::Output::log, niceness);
  };
  start("tree_broker", {(folder / "tree_broker").string(), "--seed", std::to_string(scenario.seed)},
        of_broker, 0);
  for (const RobotTask& robot : scenario.robots)
    start(robot.name, {(folder / "robot_agent").string(), "--name", robot.name}, of_agent,
          niceness_of_agents);
  const std::string service = "planner_service";
  std::vector<std::string> command = service_command(options, (folder / service).string(), network);
  command.insert(command.end(), of_service.begin(), of_service.end());
  fleet.start(service, command, ProcessFleet::Output::terminal);

  std::optional<std::chrono::steady_clock::time_point> asked;
  while (true) {
    if (stop_requested() && !asked) {
      fleet.terminate(service);
      asked = std::chrono::steady_clock::now();
    }
    const auto ended = fleet.reap();
    if (!ended && asked && std::chrono::steady_clock::now() - *asked > patience) {
      std::cerr << "the planner service does not answer: ended without a report\n";
      fleet.terminate_all(grace);
      return 1;
    }
    if (!ended) {
      std::this_thread::sleep_for(poll_period);
    } else if (ended->name == service) {
      fleet.terminate_all(grace);
      if (ended->exit_code > 2) {
        tell_of_end(*ended);
        return 1;
      }
      return ended->exit_code;
    } else {
      tell_of_end(*ended);
    }
  }
}

}  // namespace coppice
