// Estimates the share of samples that are lost, from the numbers of the states that come. From the share
// follows how many of a robot's last states may have reached nobody.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "robot_agent/timing.h"

namespace coppice {

/// Which of a peer's last states came. Only states at heartbeats are counted: all peers that are not far away
/// receive these. States may overtake each other: a missing state counts as lost only when it is some
/// heartbeats old. A peer may pause, or send fewer states to a robot that has neighbours closer by: so a
/// state counts only if the two before it and the two after it came.
class Received {
 public:
  struct Count {
    int sent = 0;
    int lost = 0;
  };

  /// A state came, of whatever age, perhaps not for the first time. Returns what has become certain by that.
  Count hear(std::uint32_t tick) {
    Count count;
    if (tick % heartbeat_interval != 0) return count;
    const std::uint32_t sequence = tick / heartbeat_interval;
    if (came_ != 0 && sequence <= newest_ && newest_ - sequence < window) {
      came_ |= 1u << (newest_ - sequence);
      return count;
    }
    const bool anew = came_ == 0 || sequence < newest_ || sequence - newest_ >= window;
    for (std::uint32_t k = anew ? 0 : sequence - newest_; k > 0; --k) {
      came_ <<= 1;
      if ((came_ & neighbours) != neighbours) continue;
      ++count.sent;
      count.lost += (came_ >> settled & 1) == 0;
    }
    came_ = anew ? 1 : came_ | 1;
    newest_ = sequence;
    return count;
  }

 private:
  static constexpr std::uint32_t window =
      32;  // heartbeats: a longer gap is a pause, a restart or a partition
  static constexpr std::uint32_t settled = 4;  // heartbeats: no state comes later
  static constexpr std::uint32_t neighbours = 0b11011u << (settled - 2);

  std::uint32_t came_ = 0;    ///< a bit for each heartbeat, the newest in bit 0
  std::uint32_t newest_ = 0;  ///< heartbeat
};

class LossCount {
 public:
  /// Fewer samples than that are never enough for one to be heard for sure, however little is lost.
  static constexpr std::size_t fewest_samples = 3;

  void add(const Received::Count& count) {
    for (int k = 0; k < count.sent; ++k) {
      sent_ = sent_ * memory + 1;
      lost_ = lost_ * memory + (k < count.lost ? 1 : 0);
    }
  }

  /// So many of a robot's last states may have reached nobody, if `samples` were sent of each. In one failure
  /// of a million there are more.
  int unheard_states(std::size_t samples) const {
    const double exponent = std::log(1e-6) / (static_cast<double>(samples) * std::log(share()));
    return static_cast<int>(std::ceil(exponent)) - 1;
  }
  /// Too few samples were counted to judge by. So it is for an agent that was just started.
  bool knows_little() const { return sent_ < few; }
  /// How often to send each state to so many listeners, at least one, so that there is no such state. Never
  /// more than Timing::most_copies.
  int copies_for(std::size_t listeners) const {
    const int samples = 1 + unheard_states(1);
    const auto each = static_cast<int>(listeners);
    return std::min((samples + each - 1) / each, Timing::most_copies);
  }

 private:
  static constexpr double most_lost = 0.5;
  static constexpr double few = 20;        // samples
  static constexpr double memory = 0.995;  // counts about the last 200 samples

  double share() const { return std::min((lost_ + 1) / (sent_ + 2), most_lost); }

  double sent_ = 0;
  double lost_ = 0;
};

}  // namespace coppice
