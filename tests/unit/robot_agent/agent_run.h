// Steps a single agent by hand.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "robot_agent/robot_agent.h"
#include "tests/unit/planner_service/roles.h"

namespace coppice {

/// Steps a single agent whenever it asks to be stepped, each time `late` seconds late. Returns what it sends.
inline std::vector<Message> run(RobotAgent& agent, double from, double until, double late = 0) {
  std::vector<Message> all;
  for (double now = from; now < until; now = std::max(now + 0.001, agent.next_wake() + late)) {
    for (Message& message : messages(agent.step(now))) all.push_back(std::move(message));
  }
  return all;
}

}  // namespace coppice
