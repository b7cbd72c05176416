// robot_agent [--name NAME] --domain D: one robot, until it is told to stop.

#include <memory>
#include <random>
#include <string_view>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "bus/dds_bus.h"
#include "bus/process.h"
#include "bus/validation.h"
#include "robot_agent/nameless_agent.h"
#include "robot_agent/robot_agent.h"

namespace {

using namespace coppice;

constexpr double patience = 5;         // seconds of waiting that are worth no line
constexpr double claim_period = 1;     // seconds
constexpr double longest_braking = 5;  // seconds

struct Log {
  std::string level;
  bool as_json = false;
};

/// Until the robot stands and all has been said, or time is up: whoever told it to stop will not wait for
/// ever.
template <class Agent>
void end(DdsBus& bus, Agent& agent) {
  const WallTime latest = wall_now() + longest_braking;
  agent.retire();
  do {
    run_role_once(bus, agent);
  } while (!agent.stands() && wall_now() < latest);
  for (const Outgoing& last : agent.last_words(wall_now())) bus.publish(last);
}

int run_as(const RobotName& name, const DdsSettings& settings, Heartbeat& heart) {
  DdsBus bus(settings, Role::agent, "robot_agent " + name);
  RobotAgent agent(name);
  spdlog::info("on domain {}", settings.domain);
  while (!stop_requested()) {
    run_role_once(bus, agent);
    heart.beat(wall_now());
  }
  end(bus, agent);
  return 0;
}

/// Until it knows who it is, and then as that robot. 1: another agent is that robot now.
int run_as_whom_the_service_says(const DdsSettings& settings, Heartbeat& heart, const Log& log) {
  std::random_device device;
  const std::uint64_t id = (static_cast<std::uint64_t>(device()) << 32) | device() | 1u;
  auto asking = std::make_unique<DdsBus>(settings, Role::claimant, fmt::format("robot_agent {:016x}", id));
  NamelessAgent agent(id);
  spdlog::info("claims a robot on domain {}", settings.domain);
  const WallTime patience_ends = wall_now() + patience;
  std::string_view noted;
  while (!agent.robot() && !stop_requested()) {
    run_role_once(*asking, agent);
    heart.beat(wall_now());
    const std::string_view note = asking->matched_readers<Claim>() > 0
                                      ? "waits: no robot is free"
                                      : "waits: no planner service has been found";
    if (wall_now() < patience_ends || note == noted) continue;
    noted = note;
    spdlog::info(note);
  }
  if (!agent.robot()) return 0;
  set_up_logging("robot_agent " + *agent.robot(), log.level, log.as_json);
  spdlog::info("is {}", *agent.robot());
  // A bus of that name: who hears it knows from the beginning whose agent it is. Until it has found the
  // service, the other one keeps the claim.
  DdsBus bus({settings.domain, *agent.robot(), settings.discovery}, Role::claimant,
             "robot_agent " + *agent.robot());
  bus.publish(agent.claim(wall_now()));
  WallTime next_claim = wall_now();
  while (!agent.lost() && !stop_requested()) {
    run_role_once(bus, agent);
    heart.beat(wall_now());
    if (!asking) continue;
    if (bus.matched_readers<Claim>() > 0) {
      asking.reset();
    } else if (wall_now() >= next_claim) {
      asking->publish(agent.claim(wall_now()));
      next_claim = wall_now() + claim_period;
    }
  }
  if (!agent.lost()) {
    end(bus, agent);
    return 0;
  }
  spdlog::error("was silent for too long: another agent may be {} by now", *agent.robot());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  int domain = 0;
  std::string name;
  std::string discovery;
  std::string level = "info";
  bool log_json = false;
  std::string alive;
  CLI::App app{"Coppice robot agent: plans, drives and avoids for one robot"};
  app.set_version_flag("--version", COPPICE_VERSION);
  app.add_option("--name", name,
                 "of the robot, as the scenario names it; without, the service says which one it is");
  app.add_option("--domain", domain, "DDS domain")->check(CLI::Range(0, 232));
  app.add_option("--discovery", discovery,
                 "multicast, static, or discovery servers: HOST:PORT, several with ; between them");
  app.add_option("--alive", alive, "file that is touched every second while all is well: for health checks");
  app.add_option("--log-level", level, "trace, debug, info, warning, error or off");
  app.add_flag("--log-json", log_json, "log lines of JSON");
  try {
    app.parse(argc, argv);
    if (app.count("--name") > 0 && (name.empty() || name.size() > longest_name)) {
      throw CLI::ValidationError("--name", fmt::format("expected 1 to {} characters", longest_name));
    }
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  if (!set_up_logging(name.empty() ? "robot_agent" : "robot_agent " + name, level, log_json)) {
    std::cerr << "--log-level: unknown level " << level << '\n';
    return 2;
  }
  install_stop_signals();
  try {
    const DdsSettings settings{.domain = domain, .robot = name, .discovery = discovery};
    Heartbeat heart(alive);
    return name.empty() ? run_as_whom_the_service_says(settings, heart, {level, log_json})
                        : run_as(name, settings, heart);
  } catch (const std::exception& problem) {
    spdlog::error("{}", problem.what());
    return 2;
  }
}
