#include "planner_service/run/roll_call.h"

#include <cstddef>

#include <fmt/format.h>

#include "planner_service/timing.h"
#include "planning/quantities.h"

namespace coppice {

namespace {

constexpr std::size_t most_in_a_line = 8;  // names

std::string listed(const std::set<RobotName>& robots) {
  std::string names;
  std::size_t count = 0;
  for (const RobotName& robot : robots) {
    if (count++ == most_in_a_line) return names + fmt::format(" and {} more", robots.size() - most_in_a_line);
    names += (names.empty() ? "" : ", ") + robot;
  }
  return names;
}

}  // namespace

void RollCall::on(const Arrival& arrival) {
  const auto* const status = std::get_if<AgentStatus>(arrival.message.get());
  if (status == nullptr) return;
  missing_.erase(status->robot);
  if (!robots_.contains(status->robot) && without_mission_.size() < most_robots)
    without_mission_.insert(status->robot);
}

std::vector<std::string> RollCall::step(WallTime now) {
  std::vector<std::string> lines;
  if (without_mission_ != without_mission_logged_) {
    without_mission_logged_ = without_mission_;
    lines.push_back(
        fmt::format("no mission for {}: the run has {}", listed(without_mission_), listed(robots_)));
  }
  const WallTime patience = service_timing.roll_call_base +
                            service_timing.roll_call_per_robot * static_cast<double>(robots_.size());
  if (now - since_ < patience) return lines;
  if (!missing_.empty() && missing_logged_.empty()) {
    missing_logged_ = missing_;
    lines.push_back(
        fmt::format("no agent has come for {} (robot_agent --name {})", listed(missing_), *missing_.begin()));
  }
  return lines;
}

}  // namespace coppice
