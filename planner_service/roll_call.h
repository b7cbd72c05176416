// The roll call of a run: agents whose robots no mission names, and missions for which no agent came.
//
// A state machine, beside the planner service: messages and the time go in, lines of a log come out.
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
      : missing_(robots.begin(), robots.end()), robots_(missing_), begun_(now) {}

  void on(const Arrival& arrival);
  /// What is to be told now: once, and again when there is news.
  std::vector<std::string> step(WallTime now);

 private:
  std::set<RobotName> missing_;  ///< no agent has come for these
  std::set<RobotName> robots_;
  std::set<RobotName> strangers_;  ///< agents that came, and are in no mission
  std::set<RobotName> missing_told_;
  std::set<RobotName> strangers_told_;
  WallTime begun_;
};

}  // namespace coppice
