#include "robot_agent/process/run_named.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "robot_agent/process/agent_loop.h"

namespace coppice {

int run_named(const AgentOptions& options, Heartbeat& heart) {
  const RobotName& name = options.name;
  ProcessClock clock(options.process.state);
  RestoredProcess restored = restored_process(name, options, [&] { heart.beat(clock.now()); });
  DdsSettings network = options.process.network;
  network.robot = name;
  DdsBus bus(network, Role::agent, "robot_agent " + name);
  RobotAgent agent(name);
  Listeners listeners(restored, options, bus, name, agent, clock);
  if (const auto tracking = tracking_of(options.ros)) agent.track_robot(*tracking);
  agent.restore(std::move(restored.saved_state));
  spdlog::info("on domain {}", network.domain);
  while (!stop_requested()) {
    turn(bus, agent, listeners, clock);
    heart.beat(clock.now());
  }
  end(bus, agent, listeners, clock);
  return 0;
}

}  // namespace coppice
