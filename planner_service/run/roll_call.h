// Log lines about agents whose robots have no mission, and about robots for which no agent came.
//
// A state machine, beside the planner service: messages and the time go in, log lines come out.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"

namespace coppice {

class RollCall {
 public:
  /// `robots`: those that have missions.
  RollCall(const std::vector<RobotName>& robots, WallTime now)
      : missing_(robots.begin(), robots.end()), robots_(missing_), since_(now) {}

  void on(const Arrival& arrival);
  /// The lines to log now. Agents without a mission are logged again when there are more of them.
  std::vector<std::string> step(WallTime now);

 private:
  std::set<RobotName> missing_;  ///< robots for which no agent has come
  std::set<RobotName> robots_;
  std::set<RobotName> without_mission_;  ///< robots of agents that came
  std::set<RobotName> missing_logged_;
  std::set<RobotName> without_mission_logged_;
  WallTime since_;
};

}  // namespace coppice
