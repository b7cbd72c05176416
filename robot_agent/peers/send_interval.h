// How often a robot sends its state to a peer. The longer it would take the two to meet, the longer the send
// interval.
//
// Close peers and a few witnesses receive every state. Others receive every second, fourth, ... state. So
// what a robot hears grows with the number of peers around it, not with the fleet. A state that was not heard
// is never taken for granted: the bounds of motion/body/promise.h grow with the age of a state.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "messages/messages.h"
#include "robot_agent/timing.h"

namespace coppice {

/// Ticks between two states, a power of two. `gap`: metres between the two robots; `closing_speed`: the most
/// at which the gap shrinks. The interval grows with the square of the time until the two may touch, but
/// takes no more than a fixed share of that: otherwise the next state of a robot that comes from far away
/// could be due when the two are close.
inline int send_interval(double gap, double closing_speed) {
  const double seconds = std::max(0.0, gap) / closing_speed;
  const double times = seconds / Timing::close;
  const double share = Timing::interval_share * seconds / control_period;
  const double ticks = std::clamp(std::min(times * times, share), 1.0, static_cast<double>(longest_interval));
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(ticks)));
}

/// Ticks between two states to a peer that was not heard yet, at most, in a fleet with so many peers.
inline int handshake_interval(std::size_t peers) {
  const auto ticks = std::bit_floor(std::max<std::size_t>(1, peers / Timing::answers_a_tick));
  return std::min(Timing::longest_handshake_interval, static_cast<int>(ticks));
}

/// Tells at which ticks of a long interval a peer is told something. A robot that stands speaks at heartbeats
/// only: so this is a multiple of the heartbeat interval, below 128.
inline std::uint32_t phase_of(const RobotName& robot) {
  return static_cast<std::uint32_t>(std::hash<RobotName>{}(robot) % longest_interval / heartbeat_interval *
                                    heartbeat_interval);
}
inline bool is_tick_of(std::uint32_t phase, std::uint32_t tick, int interval) {
  return ((tick + phase) & (static_cast<std::uint32_t>(interval) - 1)) == 0;  // intervals are powers of two
}
/// The first such tick after this one.
inline std::uint32_t next_tick_of(std::uint32_t phase, std::uint32_t tick, int interval) {
  const auto ticks = static_cast<std::uint32_t>(interval);
  return tick + ticks - ((tick + phase) & (ticks - 1));
}

}  // namespace coppice
