// The clock of a process. It follows the clock of the system, and never jumps (runtime/disciplined_clock.h).
// A process that is started anew with the same folder of states goes on with the time of the one before it,
// and so do all processes of a fleet on this host: otherwise a process that starts after the system's clock
// was set would live in another time than its fleet and its own journal.
//
// The folder's file "clock" holds the boot of the machine, what the oscillator counted, and the time then. It
// counts until the machine is started anew. It is written when this clock has come off by more than
// `worth_keeping`: seldom.
//
// Seconds.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "runtime/disciplined_clock.h"

namespace coppice {

/// A moment by the oscillator and by a clock.
struct ClockMark {
  std::string boot;  ///< the oscillator counts from then
  double oscillator = 0;
  WallTime time = 0;

  WallTime time_at(double count) const { return time + (count - oscillator); }
};

/// The mark in a text that text_of() wrote. None: it is no such text.
std::optional<ClockMark> clock_mark_in(const std::string& text);
std::string text_of(const ClockMark& mark);
/// Where a clock begins that was read now: with the kept time if that is of the same boot, else with the
/// system's.
DisciplinedClock clock_from(const std::optional<ClockMark>& kept, const std::string& boot,
                            const DisciplinedClock::Reading& now);

class ProcessClock {
 public:
  static constexpr double worth_keeping = 0.01;
  /// A change of the system's clock that is worth a line in the log.
  static constexpr double worth_telling = 0.5;

  /// `folder`: of states (--state); empty: the time is not kept.
  explicit ProcessClock(const std::string& folder = {});

  /// Reads the clocks, and goes on. Logs if the system's clock was set.
  WallTime now();
  /// A time by the system's clock, of a moment shortly before the last reading.
  WallTime time_of(WallTime system) const { return clock_.time_of(system); }
  /// A time by the clock of the system as this clock has it, and the inverse.
  WallTime from_system(WallTime time) const { return clock_.from_system(time); }
  WallTime by_system(WallTime time) const { return clock_.by_system(time); }

 private:
  void tell();
  void keep(const DisciplinedClock::Reading& reading);

  std::filesystem::path file_;  ///< empty: none
  std::string boot_;
  std::optional<ClockMark> kept_;
  DisciplinedClock clock_;
};

}  // namespace coppice
