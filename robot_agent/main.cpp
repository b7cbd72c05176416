// robot_agent [--name NAME] --domain D: one robot, until it is told to stop.

#include <memory>
#include <random>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bus/dds_bus.h"
#include "bus/journal.h"
#include "bus/keep.h"
#include "bus/process.h"
#include "bus/process_options.h"
#include "bus/validation.h"
#include "robot_agent/memory.h"
#include "robot_agent/nameless_agent.h"
#include "robot_agent/robot_agent.h"

namespace {

using namespace coppice;

constexpr double patience = 5;         // seconds of waiting that are worth no line
constexpr double claim_period = 1;     // seconds
constexpr double longest_braking = 5;  // seconds

/// What is known of the robot from before, and where that goes on.
struct Recalled {
  std::optional<Journal> journal;
  std::vector<Message> kept;

  Keeper<Remembrance, Journal> keeper(const RobotName& robot) {
    Remembrance remembrance(robot);
    remembrance.recall(kept);
    return {std::move(remembrance), journal ? &*journal : nullptr};
  }
};

Recalled recalled(const std::string& folder, const RobotName& robot) {
  Recalled all{journal_in(folder, robot), {}};
  if (!all.journal) return all;
  if (!all.journal->complete()) {
    throw std::runtime_error(
        fmt::format("{}: the disk was full when it was written, so that it does not say where the robot is: "
                    "remove it once "
                    "the robot stands at the start of its mission",
                    all.journal->file().string()));
  }
  all.kept = all.journal->take_recalled();
  return all;
}

/// Until the robot stands and all has been said, or time is up: whoever told it to stop will not wait for
/// ever.
template <class Agent, class K>
void end(DdsBus& bus, Agent& agent, K& keeper) {
  const WallTime latest = wall_now() + longest_braking;
  agent.retire();
  do {
    run_role_once(bus, agent, keeper);
  } while (!agent.stands() && wall_now() < latest);
  for (const Outgoing& last : agent.last_words(wall_now())) {
    keeper.said(last.message);
    bus.publish(last);
  }
}

int run_as(const RobotName& name, const ProcessOptions& options, Heartbeat& heart) {
  Recalled before = recalled(options.state, name);
  auto keeper = before.keeper(name);
  DdsSettings network = options.network;
  network.robot = name;
  DdsBus bus(network, Role::agent, "robot_agent " + name);
  RobotAgent agent(name);
  agent.recall(before.kept);
  spdlog::info("on domain {}", network.domain);
  while (!stop_requested()) {
    run_role_once(bus, agent, keeper);
    heart.beat(wall_now());
  }
  end(bus, agent, keeper);
  return 0;
}

/// False: told to stop before that.
bool wait_for_a_robot(DdsBus& asking, NamelessAgent& agent, Heartbeat& heart) {
  KeepsNothing keeper;
  const WallTime patience_ends = wall_now() + patience;
  std::string_view noted;
  while (!agent.robot() && !stop_requested()) {
    run_role_once(asking, agent, keeper);
    heart.beat(wall_now());
    const std::string_view note = asking.matched_readers<Claim>() > 0
                                      ? "waits: no robot is free"
                                      : "waits: no planner service has been found";
    if (wall_now() < patience_ends || note == noted) continue;
    noted = note;
    spdlog::info(note);
  }
  return agent.robot().has_value();
}

/// Until it knows who it is, and then as that robot. 1: another agent is that robot now.
int run_as_whom_the_service_says(const ProcessOptions& options, Heartbeat& heart) {
  std::random_device device;
  const std::uint64_t id = (static_cast<std::uint64_t>(device()) << 32) | device() | 1u;
  auto asking =
      std::make_unique<DdsBus>(options.network, Role::claimant, fmt::format("robot_agent {:016x}", id));
  NamelessAgent agent(id);
  spdlog::info("claims a robot on domain {}", options.network.domain);
  if (!wait_for_a_robot(*asking, agent, heart)) return 0;
  const RobotName robot = *agent.robot();
  set_up_logging("robot_agent " + robot, options.log_level, options.log_json);
  spdlog::info("is {}", robot);
  Recalled before = recalled(options.state, robot);
  auto keeper = before.keeper(robot);
  agent.begin(before.kept);
  // A bus of that name: who hears it knows from the beginning whose agent it is. Until it has found the
  // service, the other one keeps the claim.
  DdsSettings network = options.network;
  network.robot = robot;
  DdsBus bus(network, Role::claimant, "robot_agent " + robot);
  bus.publish(agent.claim(wall_now()));
  WallTime next_claim = wall_now();
  while (!agent.lost() && !stop_requested()) {
    run_role_once(bus, agent, keeper);
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
    end(bus, agent, keeper);
    return 0;
  }
  spdlog::error("was silent for too long: another agent may be {} by now", robot);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  ProcessOptions options;
  std::string name;
  CLI::App app{"Coppice robot agent: plans, drives and avoids for one robot"};
  app.set_version_flag("--version", COPPICE_VERSION);
  app.add_option("--name", name,
                 "of the robot, as the scenario names it; without, the service says which one it is");
  add_process_options(app, options);
  try {
    app.parse(argc, argv);
    if (app.count("--name") > 0 && (name.empty() || name.size() > longest_name)) {
      throw CLI::ValidationError("--name", fmt::format("expected 1 to {} characters", longest_name));
    }
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? 0 : 2;
  }
  set_up_logging(name.empty() ? "robot_agent" : "robot_agent " + name, options.log_level, options.log_json);
  install_stop_signals();
  try {
    Heartbeat heart(options.alive);
    return name.empty() ? run_as_whom_the_service_says(options, heart) : run_as(name, options, heart);
  } catch (const std::exception& problem) {
    spdlog::error("{}", problem.what());
    return 2;
  }
}
