// An agent that was started without a name. It asks the service for a robot, and then acts as the agent of
// that robot. It needs nothing that it hears before: the bus that it opens for the robot tells it everything
// again.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "robot_agent/process/claimant.h"
#include "robot_agent/process/robot_agent.h"

namespace coppice {

class NamelessAgent {
 public:
  explicit NamelessAgent(std::uint64_t id) : claimant_(id) {}

  void on(const Arrival& arrival);
  std::vector<Outgoing> step(WallTime now);
  WallTime next_wake() const;

  /// As in RobotAgent. An agent that has no robot stands, and has nothing to say.
  void note(const BusCounts& counts, WallTime now);
  void retire();
  bool stands() const { return !agent_ || lost() || agent_->stands(); }
  std::vector<Outgoing> final_messages(WallTime now);

  /// Begins to act for the robot that was assigned, from its saved state (saved_state.h) if there is one.
  /// `tracking`: of a robot that is elsewhere.
  void begin(std::optional<SavedState> saved, const std::optional<TrackingSettings>& tracking = {});

  /// The agent of the assigned robot. Only after begin().
  RobotAgent& agent() { return *agent_; }

  /// The assigned robot; none: not yet.
  const std::optional<RobotName>& robot() const { return claimant_.robot(); }
  /// The lease of the robot has ended. The agent says nothing any more.
  bool lost() const { return claimant_.lost(); }
  /// Renews the lease. An agent that reads its journal calls this at least every two seconds.
  Claim claim(WallTime now) { return claimant_.claim(now); }

 private:
  Claimant claimant_;
  std::optional<RobotAgent> agent_;
};

}  // namespace coppice
