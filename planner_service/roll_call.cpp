#include "planner_service/roll_call.h"

#include <cstddef>

#include <fmt/format.h>

#include "planning/quantities.h"

namespace coppice {

namespace {

constexpr WallTime patience = 5;            // seconds
constexpr WallTime patience_of_each = 0.2;  // besides: processes start one after the other
constexpr std::size_t most_in_a_line = 8;   // names

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
  if (!robots_.contains(status->robot) && strangers_.size() < most_robots) strangers_.insert(status->robot);
}

std::vector<std::string> RollCall::step(WallTime now) {
  std::vector<std::string> lines;
  if (strangers_ != strangers_told_) {
    strangers_told_ = strangers_;
    lines.push_back(fmt::format("no mission for {}: the run has {}", listed(strangers_), listed(robots_)));
  }
  begun_ = std::min(begun_, now);  // the clock may have been set back
  if (now - begun_ < patience + patience_of_each * static_cast<double>(robots_.size())) return lines;
  if (!missing_.empty() && missing_told_.empty()) {
    missing_told_ = missing_;
    lines.push_back(
        fmt::format("no agent has come for {} (robot_agent --name {})", listed(missing_), *missing_.begin()));
  }
  return lines;
}

}  // namespace coppice
