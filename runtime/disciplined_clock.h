// A clock for all that a process reckons with. It follows the clock of the system, and never jumps.
//
// NTP sets the clock of the system, and lets it run faster or slower for a while: chrony by up to 8 % (its
// maxslewrate), ntpd by 500 in a million. Robots reckon with clocks whose rates differ by `clock_drift`
// (messages/clock_offset.h). So durations come from the machine's oscillator, which nobody adjusts
// (CLOCK_MONOTONIC_RAW), with the time in which the machine was suspended. This clock comes closer to that of
// the system by `most_slewed`, and no faster: after a step of the system's clock it is another clock, as if
// it were on another host.
//
// Seconds.
#pragma once

#include <utility>

#include "messages/fleet_clock.h"

namespace coppice {

class DisciplinedClock {
 public:
  /// Of what an oscillator counts. Oscillators are off by up to 1 in 10,000.
  static constexpr double most_slewed = 5e-5;

  struct Reading {
    double oscillator = 0;  ///< since the machine was started
    WallTime system = 0;    ///< since the Unix epoch
  };
  static Reading read();

  explicit DisciplinedClock(const Reading& first) : DisciplinedClock(first, first.system) {}
  /// `time`: of this clock at the first reading.
  DisciplinedClock(const Reading& first, WallTime time) : last_(first), time_(time) {}

  /// Goes on to a later reading.
  void go_on(const Reading& now);
  /// At the last reading.
  WallTime time() const { return time_; }
  /// By how much the system's clock was set, in all, since the last call. Slewing does not count.
  double take_steps() { return std::exchange(steps_, 0); }
  /// A time by the system's clock, of a moment shortly before the last reading.
  WallTime time_of(WallTime system) const;
  /// A time by this clock as the system's clock has it, and the inverse.
  WallTime by_system(WallTime time) const { return time - time_ + last_.system; }
  WallTime from_system(WallTime time) const { return time - last_.system + time_; }

 private:
  Reading last_;
  WallTime time_;
  double steps_ = 0;
};

}  // namespace coppice
