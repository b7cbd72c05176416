// Tests of the clock by which an agent keeps time, whatever happens to the clock of the system.
#include "runtime/disciplined_clock.h"

#include <ctime>
#include <functional>

#include <gtest/gtest.h>

namespace coppice {
namespace {

constexpr double started = 1000;   // the oscillator's count
constexpr double epoch = 1.7e9;    // of the system's clock then
constexpr double rounding = 1e-6;  // seconds: of times that count from the Unix epoch
constexpr double hour = 3600;

/// Reads the two clocks at times that the test sets.
class Readings {
 public:
  /// Both clocks count for so many seconds; that of the system faster by `rate`.
  void pass(double seconds, double rate) {
    now_.oscillator += seconds;
    now_.system += (1 + rate) * seconds;
    clock_.go_on(now_);
  }
  void set_system(double by) {
    now_.system += by;
    clock_.go_on(now_);
  }
  double oscillator() const { return now_.oscillator; }
  WallTime system() const { return now_.system; }
  WallTime time() const { return clock_.time_of(now_.system); }
  const DisciplinedClock& clock() const { return clock_; }
  double take_steps() { return clock_.take_steps(); }

 private:
  DisciplinedClock::Reading now_{started, epoch};
  DisciplinedClock clock_{now_};
};

/// Does this twenty times. No rate is further from that of the oscillator than it may be.
void expect_even_time(const std::function<void(Readings&, int)>& disturb) {
  Readings readings;
  for (int k = 0; k < 20; ++k) {
    const double oscillator = readings.oscillator();
    const WallTime time = readings.time();
    disturb(readings, k);
    const double passed = readings.oscillator() - oscillator;
    EXPECT_NEAR(readings.time() - time, passed, DisciplinedClock::most_slewed * passed + rounding) << k;
    EXPECT_GE(readings.time(), time) << k;
  }
}

TEST(DisciplinedClock, ItsRateIsThatOfTheOscillatorHoweverTheSystemsClockIsSlewed) {
  for (const double slewed : {0.08, -0.08, 5e-4, -5e-4}) {
    expect_even_time([&](Readings& readings, int) { readings.pass(10, slewed); });
    expect_even_time([&](Readings& readings, int k) { readings.pass(10, k % 2 == 0 ? slewed : -slewed); });
  }
}

TEST(DisciplinedClock, ItDoesNotJumpWhenTheSystemsClockIsSet) {
  for (const double step : {hour, -hour, 0.3, -0.3}) {
    expect_even_time([&](Readings& readings, int k) {
      readings.set_system(k % 2 == 0 ? step : -step);
      readings.pass(0.05, 0);
    });
  }
}

// The machine was suspended for an hour: both clocks count it, the system's perhaps later.
TEST(DisciplinedClock, ItCountsTheTimeInWhichTheMachineWasSuspended) {
  expect_even_time([](Readings& readings, int) { readings.pass(hour, 0); });
  expect_even_time([](Readings& readings, int) {
    readings.pass(hour, -1);
    readings.set_system(hour);
  });
}

TEST(DisciplinedClock, ItsReadingIncludesTheTimeInWhichTheMachineWasSuspended) {
  const auto seconds_of = [](clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const double suspended = seconds_of(CLOCK_BOOTTIME) - seconds_of(CLOCK_MONOTONIC);
  const double least = seconds_of(CLOCK_MONOTONIC_RAW) + suspended;
  const double read = DisciplinedClock::read().oscillator;
  EXPECT_GE(read, least - 0.01);
  EXPECT_LE(read, seconds_of(CLOCK_MONOTONIC_RAW) + suspended + 0.01);
}

// Oscillators are off by so much, and NTP sets the rate of the system's clock right.
TEST(DisciplinedClock, ItFollowsAClockWhoseRateDiffersAsOscillatorsDo) {
  for (const double rate : {2e-5, -2e-5}) {
    Readings readings;
    readings.set_system(0.01);
    for (int k = 0; k < 20000; ++k) readings.pass(0.05, rate);
    EXPECT_NEAR(readings.time(), readings.system(), rounding) << rate;
  }
}

TEST(DisciplinedClock, AStampFromBeforeAStepCountsAsOfNow) {
  Readings readings;
  readings.pass(10, 0);
  const WallTime before = readings.system();
  for (const double step : {hour, -hour}) {
    readings.set_system(step);
    EXPECT_EQ(readings.clock().time_of(before), readings.time()) << step;
    EXPECT_NEAR(readings.clock().time_of(readings.system() - 0.2), readings.time() - 0.2, rounding) << step;
    readings.set_system(-step);
  }
}

TEST(DisciplinedClock, TheSystemsTimeOfAMomentIsTheInverse) {
  Readings readings;
  readings.pass(10, 0.08);
  for (const double step : {0.0, hour, -hour}) {
    readings.set_system(step);
    for (const double age : {0.0, 0.1, 0.4}) {
      const WallTime system = readings.system() - age;
      EXPECT_NEAR(readings.clock().by_system(readings.clock().time_of(system)), system, rounding) << step;
      EXPECT_NEAR(readings.clock().from_system(system), readings.clock().time_of(system), rounding) << step;
    }
  }
}

TEST(DisciplinedClock, ItTellsByHowMuchTheSystemsClockWasSet) {
  Readings readings;
  for (int k = 0; k < 100; ++k) readings.pass(0.05, k % 2 == 0 ? 0.08 : -0.08);
  readings.pass(hour, 5e-4);
  EXPECT_EQ(readings.take_steps(), 0) << "slewed only";
  readings.set_system(-hour);
  readings.pass(10, 0);
  readings.set_system(30);
  EXPECT_NEAR(readings.take_steps(), 30 - hour, rounding);
  EXPECT_EQ(readings.take_steps(), 0);
}

}  // namespace
}  // namespace coppice
