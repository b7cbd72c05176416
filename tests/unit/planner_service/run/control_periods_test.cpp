// Tests of the count of an agent's control periods.
#include <gtest/gtest.h>

#include "planner_service/report/robot_record.h"

namespace coppice {
namespace {

AgentLoad load(std::uint32_t periods, std::uint32_t missed) {
  AgentLoad load;
  load.periods = periods;
  load.periods_missed = missed;
  return load;
}

TEST(ControlPeriods, ThoseBeforeTheRunDoNotCount) {
  ControlPeriods counted;
  counted.count(load(100, 7), true);
  counted.count(load(150, 9), false);
  EXPECT_EQ(counted.all(), 50U);
  EXPECT_EQ(counted.missed(), 2U);
}

TEST(ControlPeriods, ARestartedProcessAddsToThoseBefore) {
  ControlPeriods counted;
  counted.count(load(100, 7), true);
  counted.count(load(150, 9), false);
  counted.count(load(20, 1), false);
  counted.count(load(30, 4), false);
  EXPECT_EQ(counted.all(), 60U);
  EXPECT_EQ(counted.missed(), 5U);
}

TEST(ControlPeriods, ARestartedProcessIsKnownByItsMissedPeriodsToo) {
  ControlPeriods counted;
  counted.count(load(10, 7), true);
  counted.count(load(12, 0), false);  // restarted, and heard for the first time after 12 periods
  counted.count(load(20, 1), false);
  EXPECT_LE(counted.missed(), counted.all());
  EXPECT_EQ(counted.missed(), 1U);
}

}  // namespace
}  // namespace coppice
