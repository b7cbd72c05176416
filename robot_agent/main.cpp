// robot_agent [--name NAME] --domain D: one robot, until it is told to stop.

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "dds/dds_bus.h"
#include "messages/keep.h"
#include "robot_agent/event_log.h"
#include "robot_agent/nameless_agent.h"
#include "robot_agent/options.h"
#include "robot_agent/robot_agent.h"
#include "robot_agent/ros_link.h"
#include "robot_agent/saved_state.h"
#include "runtime/command_line.h"
#include "runtime/journal.h"
#include "runtime/process.h"

namespace {

using namespace coppice;

constexpr double patience = 5;         // seconds of waiting that are worth no line
constexpr double claim_period = 1;     // seconds
constexpr double longest_braking = 5;  // seconds

std::optional<TrackingSettings> tracking_of(const RosOptions& options) {
  if (!options.drives) return std::nullopt;
  return TrackingSettings{.tolerance = options.tolerance, .patience = options.patience};
}

/// What is known of the robot from before, and where that goes on.
struct Past {
  std::optional<Journal> journal;
  StateKeeper chooser;
  std::optional<SavedState> saved_state{};

  Keeper<StateKeeper, Journal> keeper() { return {std::move(chooser), journal ? &*journal : nullptr}; }
};

/// Its journal's name is no other process's, whatever the robot is called. `meanwhile`: called again and
/// again, for a long one takes seconds to read.
Past past_of(const RobotName& robot, const AgentOptions& options, const std::function<void()>& meanwhile) {
  Past past{journal_in(options.process.state, "robot-" + robot, meanwhile),
            StateKeeper(robot, options.ros.drives)};
  if (!past.journal) return past;
  if (!past.journal->complete()) {
    throw std::runtime_error(
        fmt::format("{}: the disk was full when it was written, so that it does not say where the robot is: "
                    "remove it once "
                    "the robot stands at the start of its mission",
                    past.journal->file().string()));
  }
  SavedStateBuilder builder;
  past.journal->for_each([&](const Message& message) {
    past.chooser.restore({&message, 1});
    builder.add(message);
    meanwhile();
  });
  past.saved_state = std::move(builder).saved_state();
  if (past.saved_state && past.saved_state->mission.robot != robot)
    throw std::runtime_error(fmt::format("{}: is of robot {}: remove it, or name another folder",
                                         past.journal->file().string(), past.saved_state->mission.robot));
  return past;
}

std::unique_ptr<RosLink> ros_link(const RosOptions& options, DdsBus& bus, const RobotName& robot) {
  return options.on ? std::make_unique<RosLink>(bus, robot, options.drives) : nullptr;
}

/// All who listen to what a robot's agent hears and says.
struct Listeners {
  Keeper<StateKeeper, Journal> keeper;
  std::unique_ptr<RosLink> ros;
  EventLog event_log;

  void heard(const Message& message) {
    keeper.heard(message);
    event_log.heard(message);
    if (ros) ros->heard(message);
  }
  void said(const Message& message) {
    keeper.said(message);
    for (const EventLog::Line& line : event_log.said(message, wall_now()))
      spdlog::log(line.is_warning ? spdlog::level::warn : spdlog::level::info, "{}", line.text);
    if (ros) ros->said(message);
  }
};

RobotAgent& robot_of(RobotAgent& agent) {
  return agent;
}
RobotAgent& robot_of(NamelessAgent& agent) {
  return agent.agent();
}

template <class Agent>
void turn(DdsBus& bus, Agent& agent, Listeners& listeners) {
  run_role_once(bus, agent, listeners);
  if (listeners.ros) listeners.ros->turn(robot_of(agent), wall_now());
}

/// Until the robot stands and all has been said, or time is up: whoever told it to stop will not wait for
/// ever.
template <class Agent>
void end(DdsBus& bus, Agent& agent, Listeners& listeners) {
  const WallTime latest = wall_now() + longest_braking;
  agent.retire();
  do {
    turn(bus, agent, listeners);
  } while (!agent.stands() && wall_now() < latest);
  for (const Outgoing& last : agent.last_words(wall_now())) {
    listeners.said(last.message);
    bus.publish(last);
  }
}

int run_as(const RobotName& name, const AgentOptions& options, Heartbeat& heart) {
  Past past = past_of(name, options, [&] { heart.beat(wall_now()); });
  DdsSettings network = options.process.network;
  network.robot = name;
  DdsBus bus(network, Role::agent, "robot_agent " + name);
  Listeners listeners{past.keeper(), ros_link(options.ros, bus, name), EventLog(name)};
  RobotAgent agent(name);
  if (const auto tracking = tracking_of(options.ros)) agent.lead(*tracking);
  agent.restore(std::move(past.saved_state));
  spdlog::info("on domain {}", network.domain);
  while (!stop_requested()) {
    turn(bus, agent, listeners);
    heart.beat(wall_now());
  }
  end(bus, agent, listeners);
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

/// Whoever was that robot before may only be paused, and have its journal open: it ends as soon as it goes
/// on, for it has been silent for too long. None: told to stop before that, or another agent is that robot.
std::optional<Past> past_once_it_is_free(const AgentOptions& options, DdsBus& asking, NamelessAgent& agent,
                                         const std::function<void()>& meanwhile) {
  KeepsNothing keeper;
  for (bool told = false; !agent.lost() && !stop_requested(); told = true) {
    try {
      return past_of(*agent.robot(), options, meanwhile);
    } catch (const JournalInUse& problem) {
      if (!told) spdlog::warn("{}: waits for that one to end", problem.what());
    }
    run_role_once(asking, agent, keeper);
    meanwhile();
  }
  return std::nullopt;
}

/// Until it knows who it is, and then as that robot. 1: another agent is that robot now.
int run_as_whom_the_service_says(const AgentOptions& all_options, Heartbeat& heart) {
  const ProcessOptions& options = all_options.process;
  std::random_device device;
  const std::uint64_t id = (static_cast<std::uint64_t>(device()) << 32) | device() | 1u;
  auto asking =
      std::make_unique<DdsBus>(options.network, Role::claimant, fmt::format("robot_agent {:016x}", id));
  NamelessAgent agent(id);
  spdlog::info("claims a robot on domain {}", options.network.domain);
  if (!wait_for_a_robot(*asking, agent, heart)) return 0;
  const RobotName robot = *agent.robot();
  set_up_logging("robot_agent " + robot, options.log.level, options.log.json);
  spdlog::info("is {}", robot);
  WallTime last_claim = wall_now();
  const auto claim_again = [&](DdsBus& on) {
    last_claim = wall_now();
    const Claim claim = agent.claim(last_claim);
    if (!agent.lost()) on.publish(claim);
  };
  const auto keep_the_claim = [&] {
    heart.beat(wall_now());
    if (asking && std::abs(wall_now() - last_claim) >= claim_period) claim_again(*asking);
  };
  if (std::optional<Past> past = past_once_it_is_free(all_options, *asking, agent, keep_the_claim)) {
    agent.begin(std::move(past->saved_state), tracking_of(all_options.ros));
    // A bus of that name: who hears it knows from the beginning whose agent it is. Until it has found the
    // service, the other one keeps the claim.
    DdsSettings network = options.network;
    network.robot = robot;
    DdsBus bus(network, Role::claimant, "robot_agent " + robot);
    Listeners listeners{past->keeper(), ros_link(all_options.ros, bus, robot), EventLog(robot)};
    claim_again(bus);
    while (!stop_requested()) {
      keep_the_claim();  // first, for it may have slept
      if (agent.lost()) break;
      turn(bus, agent, listeners);
      if (asking && bus.matched_readers<Claim>() > 0) asking.reset();
    }
    if (!agent.lost()) end(bus, agent, listeners);
  }
  if (!agent.lost()) return 0;
  spdlog::error("was silent for too long: another agent may be {} by now", robot);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  fill_standard_streams();
  CLI::App app;
  AgentOptions options;
  add_agent_options(app, options);
  if (const auto exit_code = parse(app, argc, argv)) return *exit_code;
  const std::string& name = options.name;
  set_up_logging(name.empty() ? "robot_agent" : "robot_agent " + name, options.process.log.level,
                 options.process.log.json);
  install_stop_signals();
  return exit_code_of([&] {
    check_ros(options.ros, options.process.network.discovery, options.process.network.security);
    Heartbeat heart(options.process.alive);
    return name.empty() ? run_as_whom_the_service_says(options, heart) : run_as(name, options, heart);
  });
}
