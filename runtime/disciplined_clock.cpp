#include "runtime/disciplined_clock.h"

#include <algorithm>
#include <ctime>

namespace coppice {

namespace {

/// Seconds. A message that waited for longer, or came before that, was stamped before the system's clock was
/// set.
constexpr double longest_wait_of_a_message = 0.5;

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
  last_ = now;
}

WallTime DisciplinedClock::time_of(WallTime system) const {
  const double age = last_.system - system;
  return age >= 0 && age <= longest_wait_of_a_message ? time_ - age : time_;
}

}  // namespace coppice
