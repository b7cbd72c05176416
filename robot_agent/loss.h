// How many of a robot's last states may have reached nobody: the share of samples that are lost follows from
// the gaps in the numbers of those that come.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace coppice {

class LossCount {
 public:
  /// A state came that is news; `last` was the one before it from the same robot.
  void hear(std::uint32_t last, std::uint32_t sequence) {
    sent_ = sent_ * memory + 1;
    lost_ *= memory;
    if (sequence > last && sequence - last < longest_gap) {
      sent_ += sequence - last - 1;
      lost_ += sequence - last - 1;
    }
  }

  /// More is lost than by chance, and enough came to tell.
  bool notable() const { return sent_ > 50 && share() > 0.02; }
  /// The last states that at most one death in a million loses on all its ways to `witnesses` robots.
  int unheard_states(std::size_t witnesses) const {
    const double exponent = std::log(1e-6) / (static_cast<double>(witnesses) * std::log(share()));
    return static_cast<int>(std::ceil(exponent)) - 1;
  }

 private:
  static constexpr std::uint32_t longest_gap = 20;  // states: more is a pause, a restart or a partition
  static constexpr double most_lost = 0.5;
  static constexpr double memory = 0.995;  // counts some 200 of the last

  double share() const { return std::min((lost_ + 1) / (sent_ + 2), most_lost); }

  double sent_ = 0;
  double lost_ = 0;
};

}  // namespace coppice
