// How far another process's clock is from one's own: bounds from messages that went both ways.
//
// A message that is stamped s by the other's clock and arrives at r by one's own says that the offset (own
// minus other) is at most r - s, for nothing arrives before it is sent. The other's echo of a message of
// one's own, stamped s' and received at r' by the other's clock, says that it is at least s' - r'. The best
// of many bounds counts; as clocks drift, each becomes looser with its age (Cristian, "Probabilistic clock
// synchronization", 1989, without the probability).
//
// Seconds, by whichever clock, as long as it is the same on both sides.
#pragma once

#include <algorithm>
#include <limits>

namespace coppice {

/// Two clocks of this kind may drift apart by so many seconds a second.
inline constexpr double clock_drift = 1e-4;

class ClockOffset {
 public:
  /// A message with this stamp of the other arrived at `now`.
  void hear(double stamp, double now) {
    loosen(now);
    most_ = std::min(most_, now - stamp);
    if (least_ > most_) least_ = -infinity;  // a clock was set anew: what was known before is void
  }
  /// The other says that a message of one's own, stamped `sent`, arrived there at `received` by its clock.
  void hear_echo(double sent, double received, double now) {
    loosen(now);
    // It may have been repeated for long.
    least_ = std::max(least_, sent - received - clock_drift * std::max(0.0, now - sent));
    if (least_ > most_) most_ = infinity;
  }

  /// Bounded on both sides.
  bool known() const { return least_ > -infinity && most_ < infinity; }
  /// Own clock minus the other's, in the middle of the bounds. While only one bound is known, that one.
  double estimate() const { return known() ? (least_ + most_) / 2 : most_ < infinity ? most_ : 0; }
  /// By how much the estimate may be wrong at `now`; infinity until it is known.
  double error(double now) const {
    return known() ? (most_ - least_) / 2 + clock_drift * std::max(0.0, now - updated_) : infinity;
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  void loosen(double now) {
    const double drift = clock_drift * std::max(0.0, now - updated_);
    most_ += drift;
    least_ -= drift;
    updated_ = std::max(updated_, now);
  }

  double least_ = -infinity;
  double most_ = infinity;
  double updated_ = 0;
};

}  // namespace coppice
