// Which agents the planner service takes to be lost, by how long each has been silent.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "messages/messages.h"

namespace coppice {

/// How far an agent is in the run. This decides how long the service waits for it.
enum class AgentStage : unsigned char {
  expected,  ///< it has not taken up its mission
  active,
  stopped,  ///< it has confirmed that its mission is cancelled
};

class Liveliness {
 public:
  Liveliness(std::size_t robots, WallTime now) : agents_(robots, Agent{now}), last_step_(now) {}

  void heard(std::size_t robot, WallTime at) { agents_[robot] = {at}; }
  /// The service before this one last heard the agent then.
  void heard_before_restart(std::size_t robot, WallTime at) { agents_[robot].heard_at = at; }
  /// `stages`: by robot.
  void step(std::span<const AgentStage> stages, WallTime now);

  bool is_lost(std::size_t robot) const { return agents_[robot].lost; }
  WallTime silence(std::size_t robot, WallTime now) const { return now - agents_[robot].heard_at; }
  WallTime last_step() const { return last_step_; }

 private:
  struct Agent {
    WallTime heard_at = 0;
    bool lost = false;  ///< until it is heard again
  };

  void follow_clock(WallTime now);

  std::vector<Agent> agents_;
  WallTime last_step_;
};

}  // namespace coppice
