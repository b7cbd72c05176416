// The code that the processes of named and unnamed agents share: they load the saved state of the robot, tell
// listeners what the agent hears and says, and run the loop.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "dds/dds_bus.h"
#include "messages/keep.h"
#include "robot_agent/control/saved_state.h"
#include "robot_agent/options.h"
#include "robot_agent/process/event_log.h"
#include "robot_agent/process/nameless_agent.h"
#include "robot_agent/process/robot_agent.h"
#include "robot_agent/process/ros_link.h"
#include "runtime/black_box.h"
#include "runtime/journal.h"
#include "runtime/process.h"

namespace coppice {

/// Returns none if the agent moves its robot itself.
std::optional<TrackingSettings> tracking_of(const RosOptions& options);

/// The content of the robot's journal, which the process before this one wrote.
struct RestoredProcess {
  std::optional<Journal> journal;
  StateKeeper chooser;
  std::optional<SavedState> saved_state{};
  std::optional<BlackBox> black_box{};  ///< for the end of this process's track

  Keeper<StateKeeper, Journal> keeper() { return {std::move(chooser), journal ? &*journal : nullptr}; }
};

/// Opens the journal and the black box of a robot, and reads the journal. `meanwhile` is called again and
/// again. Throws JournalInUse if another process has them open, and std::runtime_error if they are of no use.
RestoredProcess restored_process(const RobotName& robot, const AgentOptions& options,
                                 const std::function<void()>& meanwhile);

/// The listeners to all that a robot's agent hears and says.
struct Listeners {
  Keeper<StateKeeper, Journal> keeper;
  std::unique_ptr<RosLink> ros;  ///< null: nothing is said in ROS 2
  EventLog event_log;
  const RobotAgent& agent;
  ProcessClock& clock;
  std::optional<BlackBox> black_box;

  /// `agent`: of the robot. It and `clock` outlive this object.
  Listeners(RestoredProcess& restored, const AgentOptions& options, DdsBus& bus, const RobotName& robot,
            const RobotAgent& agent, ProcessClock& clock);
  void heard(const Message& message);
  void said(const Message& message);
  /// Keeps the journal short, after all was said.
  void tidy();
};

inline RobotAgent& robot_of(RobotAgent& agent) {
  return agent;
}
inline RobotAgent& robot_of(NamelessAgent& agent) {
  return agent.agent();
}

/// Waits, hears, decides and says, once.
template <class Agent>
void turn(DdsBus& bus, Agent& agent, Listeners& listeners, ProcessClock& clock) {
  run_role_once(bus, agent, listeners, clock);
  if (listeners.ros) listeners.ros->turn(robot_of(agent), clock);
}

/// Brakes until the robot stands, and says all that is left to say. Ends after some seconds in any case.
template <class Agent>
void end(DdsBus& bus, Agent& agent, Listeners& listeners, ProcessClock& clock) {
  constexpr WallTime longest_end = 5;  // seconds
  const WallTime latest = clock.now() + longest_end;
  agent.retire();
  do {
    turn(bus, agent, listeners, clock);
  } while (!agent.stands() && clock.now() < latest);
  for (const Outgoing& last : agent.final_messages(clock.now())) {
    listeners.said(last.message);
    bus.publish(last);
  }
}

}  // namespace coppice
