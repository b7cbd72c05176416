#include "robot_agent/process/event_log.h"

#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace coppice {

namespace {

constexpr double worth_a_line = 10;            // seconds of fleet time that a robot waits
constexpr double worth_a_warning = 30;         // the same, for a warning
constexpr double shorter = 0.01;               // change of a path's length that is worth a line, as a share
constexpr WallTime periods_counted = 10;       // seconds in which missed periods are counted
constexpr double share_worth_a_warning = 0.1;  // of the periods in these seconds that were missed
constexpr WallTime between_warnings = 60;      // seconds between two warnings of missed periods

}  // namespace

void EventLog::heard(const Message& message) {
  const auto* const mission = std::get_if<Mission>(&message);
  if (mission != nullptr && mission->robot == robot_) mission_ = *mission;
}

std::vector<EventLog::Line> EventLog::said(const Message& message, WallTime now) {
  std::vector<Line> lines;
  if (const auto* path = std::get_if<PathMessage>(&message)) say_path(*path, lines);
  if (const auto* status = std::get_if<AgentStatus>(&message)) say_status(*status, now, lines);
  return lines;
}

/// Tells of the first path of a mission, and of others whose length differs by a share that matters.
void EventLog::say_path(const PathMessage& path, std::vector<Line>& lines) {
  const double length = length_of(path.waypoints);
  if (path_length_ > 0 && std::abs(length - path_length_) < shorter * path_length_) return;
  lines.push_back({false, fmt::format("{} of {:.1f} m", path_length_ > 0 ? "another path" : "path", length)});
  path_length_ = length;
}

void EventLog::say_status(const AgentStatus& status, WallTime now, std::vector<Line>& lines) {
  const bool is_new = !last_ || !is_of_run(status, last_->run) || last_->mission != status.mission;
  if (is_new && status.mission > 0) {
    say_mission(status, lines);
    path_length_ = 0;
    wait_.reset();
  }
  const bool same = !is_new && last_->phase == status.phase && last_->reason == status.reason;
  if (!same) say_phase(status, lines);
  if (mission_ && is_of_run(status, mission_->clock.run()))
    say_wait(status, mission_->clock.fleet_time(now), lines);
  say_missed_periods(status.load, now, lines);
  last_ = status;
}

void EventLog::say_mission(const AgentStatus& status, std::vector<Line>& lines) const {
  if (!mission_ || mission_->number != status.mission || !is_of_run(status, mission_->clock.run())) return;
  const Mission& m = *mission_;
  lines.push_back(
      {false,
       fmt::format("mission {}: from ({:.2f}, {:.2f}) to ({:.2f}, {:.2f}), radius {:g} m, {:g} m/s", m.number,
                   m.start.x(), m.start.y(), m.goal.x(), m.goal.y(), m.radius, m.max_speed)});
}

void EventLog::say_phase(const AgentStatus& status, std::vector<Line>& lines) const {
  const bool had_arrived = last_ && last_->phase == Phase::arrived;
  if (status.phase == Phase::arrived)
    lines.push_back({false, fmt::format("arrived at {:.1f} s, after {:.1f} m", status.arrival_time,
                                        status.driven_length)});
  if (status.phase == Phase::stopped && !had_arrived)
    lines.push_back(
        {false, status.reason.empty() ? "was stopped" : fmt::format("was stopped: {}", status.reason)});
  const bool is_stuck = has_no_way(status.phase) || status.phase == Phase::waiting;
  if (is_stuck && !status.reason.empty()) lines.push_back({true, status.reason});
}

/// Tells of each wait once, and again when its cause has changed.
void EventLog::say_wait(const AgentStatus& status, double fleet_now, std::vector<Line>& lines) {
  const bool waits = !status.wait_cause.empty();
  if (wait_ && (!waits || wait_->since != status.came_on_at)) {
    const bool goes_on = status.phase == Phase::driving || status.phase == Phase::arrived;
    if (goes_on) lines.push_back({false, fmt::format("goes on after {:.1f} s", fleet_now - wait_->since)});
    wait_.reset();
  }
  const double waited = fleet_now - status.came_on_at;
  if (!waits || waited < worth_a_line) return;
  const bool is_warning = waited >= worth_a_warning;
  const bool is_told = wait_ && (fleet_now - wait_->told_at < worth_a_line ||
                                 (wait_->cause == status.wait_cause && (wait_->warned || !is_warning)));
  if (is_told) return;
  lines.push_back(
      {is_warning, fmt::format("has not come on since {:.1f} s: {}", status.came_on_at, status.wait_cause)});
  wait_ = {status.came_on_at, status.wait_cause, fleet_now, is_warning};
}

/// Counts the periods that were missed in the last ten seconds: what was missed long ago is told once.
void EventLog::say_missed_periods(const AgentLoad& load, WallTime now, std::vector<Line>& lines) {
  if (!count_ || now < count_->since) count_ = {now, load};
  if (now - count_->since < periods_counted) return;
  const Count before = *std::exchange(count_, Count{now, load});
  const std::uint32_t periods = load.periods - before.load.periods;
  const std::uint32_t missed = load.periods_missed - before.load.periods_missed;
  const bool told = warned_of_periods_at_ && std::abs(now - *warned_of_periods_at_) < between_warnings;
  if (told || missed <= share_worth_a_warning * periods) return;
  warned_of_periods_at_ = now;
  lines.push_back({true, fmt::format("missed {} of {} control periods in {:.0f} s: it gets too little "
                                     "processor time",
                                     missed, periods, now - before.since)});
}

}  // namespace coppice
