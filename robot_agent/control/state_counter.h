// Numbers the states of a robot, and tells when the robot has something to say.
//
// A robot that goes on standing as it has said speaks at heartbeats only, each `heartbeat_interval` ticks.
#pragma once

#include <cstdint>
#include <utility>

#include "messages/messages.h"
#include "robot_agent/peers/send_interval.h"

namespace coppice {

/// A robot that stands has news if one of these changes.
struct SpokenState {
  bool stands = false;
  Phase phase = Phase::waiting;
  RoundId round{};
  Stage stage = Stage::free;
  RobotName waits_for{};
  std::uint32_t reservation = 0;           ///< number
  std::uint32_t reservations_version = 0;  ///< of the reservations of others that it heeds
  bool shakes_hands = false;               ///< some peers may not know its clock
  bool operator==(const SpokenState&) const = default;
};

class StateCounter {
 public:
  StateCounter() = default;
  /// Goes on after the last state of the process before.
  explicit StateCounter(std::uint32_t tick) : tick_(tick), last_heartbeat_(tick / heartbeat_interval) {}

  std::uint32_t tick() const { return tick_; }
  std::uint32_t next_heartbeat() const { return tick_ - tick_ % heartbeat_interval + heartbeat_interval; }
  /// Another control period is over. A late step leaves out no number, if the robot drives, and no heartbeat:
  /// peers take gaps for lost states.
  void count_period(bool counts, std::uint32_t next_heartbeat) { tick_ += counts && tick_ < next_heartbeat; }
  /// Once in each control step. The count is of periods: a step that comes late misses no heartbeat.
  bool take_heartbeat() {
    const std::uint32_t heartbeats = tick_ / heartbeat_interval;
    return heartbeats != std::exchange(last_heartbeat_, heartbeats);
  }
  std::uint32_t heartbeats() const { return last_heartbeat_; }

  /// Once in each control step: what the robot says now.
  void note(const SpokenState& now) {
    const bool same_part = now.round == last_.round && now.stage == last_.stage;
    since_change_ = now.stands && !now.shakes_hands && now == last_ ? since_change_ + 1 : 0;
    since_round_change_ = same_part ? since_round_change_ + 1 : 0;
    last_ = now;
  }
  /// The robot has said often enough that it stands.
  bool rests() const { return since_change_ > repeat_change; }
  /// All peers of the round are to hear of this robot's part in it.
  bool has_news_of_round() const { return since_round_change_ <= repeat_round_news; }
  /// The number of the state that is said now.
  std::uint32_t tick_to_say() const { return rests() ? tick_ - tick_ % heartbeat_interval : tick_; }
  int periods_to_heartbeat() const {
    return heartbeat_interval - static_cast<int>(tick_ % heartbeat_interval);
  }

  /// A state says how often those after it are said. So the next one is said so often, at least.
  int copies(std::uint8_t wanted) {
    const std::uint8_t promised = std::exchange(copies_promised_, wanted);
    return wanted > promised ? wanted : promised;
  }

 private:
  static constexpr std::uint32_t repeat_change = 5;  // control steps in which a robot says that it stands
  // The recipients of a round's news share the copies of a state (Fleet::copies). After so many steps each of
  // them has heard one.
  static constexpr std::uint32_t repeat_round_news = sure_witnesses - 1;

  std::uint32_t tick_ = 0;
  std::uint32_t last_heartbeat_ = 0;
  std::uint32_t since_change_ = 0;        ///< control steps
  std::uint32_t since_round_change_ = 0;  ///< control steps
  SpokenState last_{};
  std::uint8_t copies_promised_ = 1;
};

}  // namespace coppice
