// What operators have told robots: to stand by a pause, by a stop, or by both. Each of the two is ended by
// its own action alone: a resume ends pauses, and a release ends stops.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "messages/messages.h"

namespace coppice {

/// What holds for a robot after an action.
inline Halt halt_after(Action action, Halt before) {
  const bool pauses = action == Action::pause || (is_paused(before) && action != Action::resume);
  const bool stops = action == Action::stop || (is_stopped(before) && action != Action::release);
  return halt_of(pauses, stops);
}

/// The halts after an action. `named`: empty: it is for all robots, also those that join later. `fleet`: the
/// robots of this fleet. Robots that are not in it any more keep their halts, for they may come back. The
/// number grows also if an earlier service left nothing to go on with.
inline HaltMessage halts_after(const HaltMessage& before, Action action, std::span<const RobotName> named,
                               std::span<const RobotName> fleet, WallTime now) {
  const auto is_meant = [&](const RobotName& robot) {
    return named.empty() || std::ranges::count(named, robot) > 0;
  };
  HaltMessage after{
      .number = std::max(before.number + 1, static_cast<std::uint64_t>(1000 * std::max(0.0, now))),
      .everybody = named.empty() ? halt_after(action, before.everybody) : before.everybody};
  const auto add = [&](const RobotName& robot) {
    const Halt own = halt_of(before, robot);
    const Halt next = is_meant(robot) ? halt_after(action, own) : own;
    if (next != after.everybody) after.robots.push_back({robot, next});
  };
  for (const RobotName& robot : fleet) add(robot);
  for (const HaltMessage::Robot& other : before.robots) {
    if (std::ranges::count(fleet, other.robot) == 0) add(other.robot);
  }
  return after;
}

}  // namespace coppice
