#include "messages/clock_offset.h"

#include <cmath>

#include <gtest/gtest.h>

#include "coppice/planning/random.h"

namespace coppice {
namespace {

TEST(ClockOffset, TheOffsetIsUnknownUntilMessagesWentBothWays) {
  ClockOffset clock;
  EXPECT_TRUE(std::isinf(clock.error(12)));
  clock.hear(10, 12);
  EXPECT_FALSE(clock.known());
  clock.hear_echo(12, 10.5, 12.5);
  EXPECT_TRUE(clock.known());
}

TEST(ClockOffset, TheBoundsHoldTheOffsetForAllDelays) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const double offset = random.uniform(-5, 5);  // own clock minus the other clock
    const double least_delay = random.uniform(0.001, 0.3);
    ClockOffset clock;
    for (int k = 0; k < 50; ++k) {
      const double now = 100 + k;  // by the own clock
      const double there = least_delay + random.uniform(0, 0.5);
      const double back = least_delay + random.uniform(0, 0.5);
      clock.hear(now - back - offset, now);
      clock.hear_echo(now - back - there, now - back - offset, now);
      EXPECT_LE(std::abs(clock.estimate() - offset), clock.error(now) + 1e-12);
    }
    EXPECT_LT(clock.error(149), least_delay + 0.25);
  }
}

TEST(ClockOffset, ARepeatedEchoLoosensTheBoundsWithItsAge) {
  ClockOffset fresh;
  fresh.hear(10, 10);
  fresh.hear_echo(10, 10, 10);
  EXPECT_DOUBLE_EQ(fresh.error(10), 0);
  ClockOffset late;
  late.hear(60, 60);
  late.hear_echo(10, 10, 60);
  EXPECT_DOUBLE_EQ(late.error(60), 50 * clock_drift / 2);
}

TEST(ClockOffset, TheBoundsLoosenWithTimeAndFollowAClockThatIsSet) {
  ClockOffset clock;
  clock.hear(10, 10.01);
  clock.hear_echo(10, 10.01, 10.02);
  const double at_first = clock.error(10.02);
  clock.hear(999, 1010);
  EXPECT_NEAR(clock.error(1010), at_first + 1000 * clock_drift, 1e-5);

  clock.hear(2000, 1011);  // the other clock jumped ahead
  EXPECT_FALSE(clock.known());
  clock.hear_echo(1011, 2000.01, 1011.02);
  EXPECT_NEAR(clock.estimate(), -989, 0.1);
}

// The clock of a robot may be behind when a run begins. Its fleet time begins below 0.
TEST(ClockOffset, TheBoundsLoosenBeforeFleetTimeZeroAsWell) {
  ClockOffset clock;
  clock.hear(0, -20);
  clock.hear_echo(-20, 0.0001, -19.9999);
  const double at_first = clock.error(-19.9999);
  EXPECT_NEAR(clock.error(-9.9999), at_first + 10 * clock_drift, 1e-9);
  clock.hear(15, -5);  // bounds it from one side
  EXPECT_NEAR(clock.error(-5), at_first + 15 * clock_drift / 2, 1e-6);
}

}  // namespace
}  // namespace coppice
