#include "monitor/recording/robot_act.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace coppice {

namespace {

constexpr double in_the_way_radii = 2;  // sums of radii between two of which one stops the other

WaitTimes difference(const WaitTimes& later, const WaitTimes& earlier) {
  WaitTimes grown;
  for (const auto kind : wait_kinds) grown.*kind = std::max(0.0, later.*kind - earlier.*kind);
  return grown;
}

/// The kind of wait that grew most; null: none grew. A robot that waits for nobody is not at a gate.
double WaitTimes::*most_grown(WaitTimes grown, const RobotState& robot) {
  if (robot.waits_for.empty()) grown.gate = 0;
  const auto most = std::ranges::max_element(wait_kinds, {}, [&](auto kind) { return grown.*kind; });
  return grown.**most > 0 ? *most : nullptr;
}

/// It waits: it is slow, and does not speed up.
bool is_slow(const RobotState& robot) {
  const double speed = robot.promise.velocity.norm();
  const bool speeds_up = robot.promise.next_velocity.norm() > speed;
  return speed < waiting_speed_share * robot.max_speed && !speeds_up;
}

bool keeps_reservations(const SeenRobot& robot) {
  return !robot.mission || reserves(robot.mission->coordination);
}

/// The state itself tells.
std::optional<Doing> told_by_state(const RobotState& robot, const WaitTimes& grown) {
  const bool is_known = sum_of(grown) > 0;
  if (!robot.waits_for.empty() && (!is_known || grown.gate > 0)) return Doing{Act::gate, robot.waits_for, {}};
  if (robot.stage == Stage::waiting && (!is_known || grown.joint_plan > 0))
    return Doing{Act::joint_plan, robot.round.leader, {}};
  return std::nullopt;
}

/// As the agent finds it (robot_agent/control/wait_cause.cpp).
Doing blocked(const FleetMoment& moment, const RobotState& robot) {
  if (const SeenRobot* const other = in_the_way(moment, robot)) return {Act::blocked, other->name, {}};
  if (robot.misses.empty()) return {.act = Act::blocked};
  return {Act::blocked, {}, fmt::format("it heard nothing of {}", fmt::join(robot.misses, ", "))};
}

Doing without_known_wait(const FleetMoment& moment, const SeenRobot& robot) {
  const SaidReservation* const own = moment.reservation(robot.name);
  const bool holds = own != nullptr && own->has_trajectory();
  if (moment.is_stranded(*robot.state)) return {Act::stranded, robot.state->round.leader, {}};
  if (!holds && keeps_reservations(robot)) return {.act = Act::reservation};
  return blocked(moment, *robot.state);
}

/// The robot is under way, and hardly moves.
Doing wait_of(const FleetMoment& moment, const SeenRobot& robot, const Waited& waited) {
  const RobotState& state = *robot.state;
  if (auto told = told_by_state(state, waited.grown)) return *told;
  const auto kind = most_grown(waited.grown, state);
  if (kind == nullptr) return without_known_wait(moment, robot);
  if (kind == &WaitTimes::startup) return {Act::startup, {}, waited.words};
  if (kind == &WaitTimes::odometry) return {Act::odometry, {}, waited.words};
  if (kind == &WaitTimes::connection) return {state.is_new ? Act::joining : Act::contact, {}, waited.words};
  if (kind == &WaitTimes::reservation) return {Act::reservation, {}, waited.words};
  if (kind == &WaitTimes::joint_plan && moment.is_stranded(state))
    return {Act::stranded, state.round.leader, waited.words};
  return without_known_wait(moment, robot);
}

Doing under_way(const FleetMoment& moment, const SeenRobot& robot, const Waited& waited) {
  const RobotState& state = *robot.state;
  const SaidReservation* const own = moment.reservation(robot.name);
  const bool holds = own != nullptr && own->has_trajectory();
  const bool stands = state.promise.velocity.isZero(0);
  if (stands && state.promise.angular_velocity != 0 && state.waits_for.empty()) return {.act = Act::turns};
  if (is_slow(state)) return wait_of(moment, robot, waited);
  return {.act = holds || !keeps_reservations(robot) ? Act::drives : Act::aside};
}

/// The reason that the status gives, if it is of the same phase.
std::string reason_of(const SeenRobot& robot) {
  return robot.status && robot.status->phase == robot.state->phase ? robot.status->reason : std::string();
}

}  // namespace

void WaitLog::on(const AgentStatus& status, WallTime at) {
  entries_[status.robot].push_back({at, status.mission, status.run, status.waits, status.wait_cause});
}

Waited WaitLog::around(const RobotName& robot, WallTime at) const {
  const auto known = entries_.find(robot);
  if (known == entries_.end()) return {};
  const std::vector<Entry>& all = known->second;
  const auto next = std::ranges::upper_bound(all, at, {}, &Entry::at);
  if (next == all.end()) return {};
  const bool has_last =
      next != all.begin() && std::prev(next)->mission == next->mission && std::prev(next)->run == next->run;
  const WaitTimes before = has_last ? std::prev(next)->waits : WaitTimes();
  return {difference(next->waits, before), next->words};
}

const SeenRobot* in_the_way(const FleetMoment& moment, const RobotState& robot) {
  const SeenRobot* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const SeenRobot& other : moment.view().robots()) {
    if (!other.state || other.name == robot.robot) continue;
    const Point2 place = position_at(*other.state, robot.promise.stamp);
    const double distance = (place - robot.promise.position).norm();
    const double gap = distance - other.state->radius;
    if (distance > in_the_way_radii * (robot.radius + other.state->radius) || gap >= least) continue;
    least = gap;
    nearest = &other;
  }
  return nearest;
}

Doing doing_of(const FleetMoment& moment, const SeenRobot& robot, const Waited& waited) {
  const bool moves = !is_slow(*robot.state);
  const std::string reason = reason_of(robot);
  switch (robot.state->phase) {
    case Phase::waiting:
      return {Act::waits, {}, reason};
    case Phase::planning:
      return {moves ? Act::leaves_wall : Act::plans, {}, waited.words};
    case Phase::driving:
      return under_way(moment, robot, waited);
    case Phase::arrived:
      return {.act = moves ? Act::aside : Act::arrived};
    case Phase::no_path:
      return {Act::no_path, {}, reason};
    case Phase::gave_up:
      return {Act::gave_up, {}, reason};
    case Phase::stopped:
      return {Act::ended, {}, reason};
    case Phase::halted:
      return {Act::halted, {}, reason};
  }
  return {};
}

}  // namespace coppice
