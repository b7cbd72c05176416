#include "monitor/view/alarms.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "messages/silence.h"

namespace coppice {

namespace {

// Shares of a robot's recent control periods. Between them an alarm lasts, so that it does not come and go.
constexpr double too_many_missed = 0.1;
constexpr double few_missed = 0.05;

/// What is wrong, and since when if that is known.
struct Finding {
  std::string text;
  std::optional<WallTime> since{};
};

/// What a rule may look at beside the robot. `lasts`: it had this alarm when the board last looked.
struct Situation {
  const FleetView& view;
  WallTime now;
  bool lasts;
};

std::optional<Finding> find_silent(const SeenRobot& robot, const Situation& situation) {
  if (!is_lost(robot, situation.now)) return std::nullopt;
  return Finding{fmt::format("{} is not heard: its agent has ended, hangs, or cannot be reached", robot.name),
                 last_heard(robot)};
}

std::optional<Finding> find_failed(const SeenRobot& robot, const Situation& situation) {
  if (!has_no_way(phase_of(robot)) || is_lost(robot, situation.now)) return std::nullopt;
  const std::string reason = robot.status ? robot.status->reason : std::string();
  return Finding{
      fmt::format("{} cannot go on: {}", robot.name, reason.empty() ? "it has no way to its goal" : reason)};
}

std::optional<Finding> find_late(const SeenRobot& robot, const Situation& situation) {
  const double limit = situation.lasts ? few_missed : too_many_missed;
  if (robot.missed.of_all < limit || is_lost(robot, situation.now)) return std::nullopt;
  return Finding{
      fmt::format("{} misses control periods, for lack of processor time, and brakes", robot.name)};
}

std::optional<Finding> find_silent_service(const Situation& situation) {
  const std::optional<SeenService>& service = situation.view.service();
  if (!service || !is_lost(service->heard, situation.now)) return std::nullopt;
  return Finding{"the planner service is not heard: it takes no orders, no stop and no pause",
                 service->heard};
}

/// A service that is silent may have been healed meanwhile.
std::optional<Finding> find_refused_orders(const Situation& situation) {
  const std::optional<SeenService>& service = situation.view.service();
  if (!service || service->status.problem.empty() || find_silent_service(situation)) return std::nullopt;
  return Finding{fmt::format("the planner service takes no new orders: {}", service->status.problem)};
}

struct RuleOfRobot {
  AlarmKind kind;
  std::optional<Finding> (*find)(const SeenRobot& robot, const Situation& situation);
};
struct RuleOfFleet {
  AlarmKind kind;
  std::optional<Finding> (*find)(const Situation& situation);
};

constexpr std::array rules_of_fleet{RuleOfFleet{AlarmKind::service_silent, find_silent_service},
                                    RuleOfFleet{AlarmKind::orders_refused, find_refused_orders}};
constexpr std::array rules_of_robots{RuleOfRobot{AlarmKind::robot_silent, find_silent},
                                     RuleOfRobot{AlarmKind::robot_failed, find_failed},
                                     RuleOfRobot{AlarmKind::periods_missed, find_late}};

}  // namespace

void AlarmBoard::look(const FleetView& view, WallTime now) {
  std::map<Name, WallTime> before = std::exchange(since_, {});
  alarms_.clear();
  if (view.life(now) == Life::ended) return;  // nobody needs to act
  const auto lasts = [&](const Name& name) { return before.contains(name); };
  const auto note = [&](const Name& name, const std::optional<Finding>& finding) {
    if (!finding) return;
    const WallTime since = lasts(name) ? before.at(name) : finding->since.value_or(now);
    since_[name] = since;
    alarms_.push_back({name.first, name.second, since, finding->text});
  };
  for (const auto& [kind, find] : rules_of_fleet) {
    const Name name{kind, {}};
    note(name, find({view, now, lasts(name)}));
  }
  for (const auto& [kind, find] : rules_of_robots) {
    for (const SeenRobot& robot : view.robots()) {
      if (!is_in_service(robot)) continue;
      const Name name{kind, robot.name};
      note(name, find(robot, {view, now, lasts(name)}));
    }
  }
}

std::size_t AlarmBoard::count(AlarmKind kind) const {
  return static_cast<std::size_t>(std::ranges::count(alarms_, kind, &Alarm::kind));
}

}  // namespace coppice
