#include "runtime/disciplined_clock.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace coppice {

namespace {

/// Seconds. A message that waited for longer, or came before that, was stamped before the system's clock was
/// set.
constexpr double longest_wait_of_a_message = 0.5;
/// NTP slews by less (chrony by up to 8 %), and the two clocks are read at almost the same time.
constexpr double most_of_slewing = 0.1;
constexpr double least_step = 0.05;  // seconds

double seconds_of(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

DisciplinedClock::Reading DisciplinedClock::read() {
  const double suspended = seconds_of(CLOCK_BOOTTIME) - seconds_of(CLOCK_MONOTONIC);
  return {seconds_of(CLOCK_MONOTONIC_RAW) + suspended, seconds_of(CLOCK_REALTIME)};
}

void DisciplinedClock::go_on(const Reading& now) {
  const double passed = std::max(0.0, now.oscillator - last_.oscillator);
  const double slewed = most_slewed * passed;
  const double behind = now.system - (time_ + passed);
  time_ += passed + std::clamp(behind, -slewed, slewed);
  const double set_by = now.system - last_.system - passed;
  if (std::abs(set_by) > most_of_slewing * passed + least_step) steps_ += set_by;
  last_ = now;
}

WallTime DisciplinedClock::time_of(WallTime system) const {
  const double age = last_.system - system;
  return age >= 0 && age <= longest_wait_of_a_message ? time_ - age : time_;
}

}  // namespace coppice
