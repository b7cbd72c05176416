#include "robot_agent/process/run_unnamed.h"

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "robot_agent/process/agent_loop.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr WallTime patience = 5;  // seconds of waiting that are worth no line

/// Returns false if the process was told to stop before it got a robot.
bool wait_for_a_robot(DdsBus& asking, NamelessAgent& agent, Heartbeat& heart, ProcessClock& clock) {
  KeepsNothing keeper;
  const WallTime patience_ends = clock.now() + patience;
  std::string_view noted;
  while (!agent.robot() && !stop_requested()) {
    run_role_once(asking, agent, keeper, clock);
    heart.beat(clock.now());
    const std::string_view note = asking.matched_readers<Claim>() > 0
                                      ? "waits: no robot is free"
                                      : "waits: no planner service has been found";
    if (clock.now() < patience_ends || note == noted) continue;
    noted = note;
    spdlog::info(note);
  }
  return agent.robot().has_value();
}

/// Opens the robot's journal. The agent that had the robot before may only be paused, and hold the journal
/// open. It ends when it continues, because its lease has ended. None: the process was told to stop before
/// that, or another agent has the robot.
std::optional<RestoredProcess> restored_process_once_it_is_free(const AgentOptions& options, DdsBus& asking,
                                                                NamelessAgent& agent, ProcessClock& clock,
                                                                const std::function<void()>& meanwhile) {
  KeepsNothing keeper;
  for (bool told = false; !agent.lost() && !stop_requested(); told = true) {
    try {
      return restored_process(*agent.robot(), options, meanwhile);
    } catch (const JournalInUse& problem) {
      if (!told) spdlog::warn("{}: waits for that one to end", problem.what());
    }
    run_role_once(asking, agent, keeper, clock);
    meanwhile();
  }
  return std::nullopt;
}

}  // namespace

int run_unnamed(const AgentOptions& all_options, Heartbeat& heart) {
  const ProcessOptions& options = all_options.process;
  std::random_device device;
  const std::uint64_t id = (static_cast<std::uint64_t>(device()) << 32) | device() | 1u;
  auto asking =
      std::make_unique<DdsBus>(options.network, Role::claimant, fmt::format("robot_agent {:016x}", id));
  NamelessAgent agent(id);
  spdlog::info("claims a robot on domain {}", options.network.domain);
  ProcessClock clock(options.state);
  if (!wait_for_a_robot(*asking, agent, heart, clock)) return 0;
  const RobotName robot = *agent.robot();
  set_up_logging("robot_agent " + robot, options.log.level, options.log.json);
  spdlog::info("is {}", robot);
  WallTime last_claim = clock.now();
  const auto claim_again = [&](DdsBus& on) {
    last_claim = clock.now();
    const Claim claim = agent.claim(last_claim);
    if (!agent.lost()) on.publish(claim);
  };
  const auto keep_the_claim = [&] {
    heart.beat(clock.now());
    if (asking && clock.now() - last_claim >= Timing::claim_renewal) claim_again(*asking);
  };
  if (std::optional<RestoredProcess> restored =
          restored_process_once_it_is_free(all_options, *asking, agent, clock, keep_the_claim)) {
    agent.begin(std::move(restored->saved_state), tracking_of(all_options.ros));
    // The bus bears the robot's name, so that peers know from the beginning whose agent this is. Until it has
    // found the service, the other bus renews the lease.
    DdsSettings network = options.network;
    network.robot = robot;
    DdsBus bus(network, Role::claimant, "robot_agent " + robot);
    Listeners listeners(*restored, all_options, bus, robot, agent.agent(), clock);
    claim_again(bus);
    while (!stop_requested()) {
      keep_the_claim();  // first: the process may have slept
      if (agent.lost()) break;
      turn(bus, agent, listeners, clock);
      if (asking && bus.matched_readers<Claim>() > 0) asking.reset();
    }
    if (!agent.lost()) end(bus, agent, listeners, clock);
  }
  if (!agent.lost()) return 0;
  spdlog::error("was silent for too long: another agent may be {} by now", robot);
  return 1;
}

}  // namespace coppice
