// How often a robot tells another of itself: the less often, the longer it would take the two to meet.
//
// A state is for those who are close, and for a few witnesses, at every tick; for others at every second,
// fourth, ... tick. So what a robot hears grows with how many are around it, not with the fleet. What is not
// heard is never taken for granted: the bounds of motion/promise.h grow with the age of a state.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>

#include "messages/messages.h"

namespace coppice {

/// In ticks; 6.4 seconds.
inline constexpr int longest_interval = 128;
/// So many of the nearest hear every state, so that its last decisions are known if it dies.
inline constexpr std::size_t witnesses = 6;
/// So many of them listen at any moment: the others may pause just then. Copies are counted for these.
inline constexpr std::size_t sure_witnesses = 3;

/// At every so many ticks, a power of two. `gap`: metres between the two; `closing_speed`: the most at which
/// it shrinks.
inline int send_interval(double gap, double closing_speed) {
  constexpr double close = 0.4;  // seconds until they might touch: every tick
  const double times = std::max(0.0, gap) / (close * closing_speed);
  const double ticks = std::clamp(times * times, 1.0, static_cast<double>(longest_interval));
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(ticks)));
}

/// Who goes on standing as it has said says so at every fourth tick.
inline constexpr int heartbeat_interval = 4;

/// At which of the ticks of a long interval it is a robot's: the same for all of a standing one.
inline std::uint32_t phase_of(const RobotName& robot) {
  return static_cast<std::uint32_t>(std::hash<RobotName>{}(robot) % longest_interval / heartbeat_interval *
                                    heartbeat_interval);
}
inline bool is_tick_of(std::uint32_t phase, std::uint32_t tick, int interval) {
  return ((tick + phase) & (static_cast<std::uint32_t>(interval) - 1)) == 0;  // strides are powers of two
}
/// The first after this one.
inline std::uint32_t next_tick_of(std::uint32_t phase, std::uint32_t tick, int interval) {
  const auto ticks = static_cast<std::uint32_t>(interval);
  return tick + ticks - ((tick + phase) & (ticks - 1));
}

}  // namespace coppice
