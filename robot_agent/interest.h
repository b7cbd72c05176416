// How often a robot tells another of itself: the less often, the longer it would take the two to meet.
//
// A state is for those who are close, and for a few witnesses, at every turn; for others at every second,
// fourth, ... turn. So what a robot hears grows with how many are around it, not with the fleet. What is not
// heard is never taken for granted: the bounds of motion/promise.h grow with the age of a state.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>

#include "messages/messages.h"

namespace coppice {

/// In turns; 6.4 seconds.
inline constexpr int longest_stride = 128;
/// So many of the nearest hear every state, so that its last decisions are known if it dies.
inline constexpr std::size_t witnesses = 6;
/// So many of them listen at any moment: the others may pause just then. Copies are counted for these.
inline constexpr std::size_t sure_witnesses = 3;

/// At every so many turns, a power of two. `gap`: metres between the two; `closing_speed`: the most at which
/// it shrinks.
inline int stride_over(double gap, double closing_speed) {
  constexpr double close = 0.4;  // seconds until they might touch: every turn
  const double times = std::max(0.0, gap) / (close * closing_speed);
  const double turns = std::clamp(times * times, 1.0, static_cast<double>(longest_stride));
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(turns)));
}

/// Who goes on standing as it has said says so at every fourth turn.
inline constexpr int standing_stride = 4;

/// At which of the turns of a long stride it is a robot's: the same for all of a standing one.
inline std::uint32_t phase_of(const RobotName& robot) {
  return static_cast<std::uint32_t>(std::hash<RobotName>{}(robot) % longest_stride / standing_stride *
                                    standing_stride);
}
inline bool is_turn_of(std::uint32_t phase, std::uint32_t turn, int stride) {
  return ((turn + phase) & (static_cast<std::uint32_t>(stride) - 1)) == 0;  // strides are powers of two
}
/// The first after this one.
inline std::uint32_t next_turn_of(std::uint32_t phase, std::uint32_t turn, int stride) {
  const auto turns = static_cast<std::uint32_t>(stride);
  return turn + turns - ((turn + phase) & (turns - 1));
}

}  // namespace coppice
