// Bounds on the offset between two clocks, from messages in both directions.
//
// A message with stamp s by the peer's clock arrives at r by the own clock. No message arrives before it is
// sent, so the offset (own minus peer) is at most r - s. The peer's echo of an own message, stamped s' and
// received at r' by the peer's clock, bounds it from below: at least s' - r'. The best bounds count. Clocks
// drift, so each bound loosens with its age (Cristian, "Probabilistic clock synchronization", 1989, without
// the probability).
//
// Seconds. Both sides use clocks of the same kind.
#pragma once

#include <algorithm>
#include <limits>

namespace coppice {

/// The drift between two clocks, at most, seconds per second: two oscillators that are off by 1 in 10,000
/// each, and by half of that on their way to the time of NTP (runtime/disciplined_clock.h).
inline constexpr double clock_drift = 3e-4;

class ClockOffset {
 public:
  /// A message with this stamp of the other arrived at `now`.
  void hear(double stamp, double now) {
    loosen(now);
    most_ = std::min(most_, now - stamp);
    if (least_ > most_) least_ = -infinity;  // a clock was set: the earlier bounds are void
  }
  /// The peer reports that an own message, stamped `sent`, arrived at `received` by the peer's clock.
  void hear_echo(double sent, double received, double now) {
    loosen(now);
    // The peer may have repeated this report for long.
    least_ = std::max(least_, sent - received - clock_drift * std::max(0.0, now - sent));
    if (least_ > most_) most_ = infinity;
  }

  /// Bounded on both sides.
  bool known() const { return least_ > -infinity && most_ < infinity; }
  /// Own clock minus the peer's, in the middle of the bounds. If only one bound is known: that bound.
  double estimate() const { return known() ? (least_ + most_) / 2 : most_ < infinity ? most_ : 0; }
  /// The largest error of the estimate at `now`; infinity until both bounds are known.
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
  double updated_ = -infinity;  ///< times may be below 0: a clock may be behind when a run begins
};

}  // namespace coppice
