// Where a robot may stand that has fallen silent, and how much of what it decided may have reached nobody.
#include <gtest/gtest.h>

#include "motion/promise.h"
#include "robot_agent/loss.h"

namespace coppice {
namespace {

constexpr double period = 0.05;

TEST(Silence, StatesLostToAllBecomeRareWithTheirNumberAndThatOfTheWitnesses) {
  LossCount third;
  for (std::uint32_t sequence = 0; sequence < 3000; sequence += 3)
    third.hear(sequence < 3 ? 0 : sequence - 3, sequence);
  // Two of three are lost: but more than half is never taken as what goes on.
  EXPECT_EQ(third.unheard_states(1), 19);  // 0.5^20 is the first below one in a million
  EXPECT_EQ(third.unheard_states(10), 1);
  EXPECT_EQ(third.unheard_states(20), 0);

  LossCount none;
  for (std::uint32_t sequence = 1; sequence < 10000; ++sequence) none.hear(sequence - 1, sequence);
  EXPECT_EQ(none.unheard_states(1), 1);
  EXPECT_EQ(none.unheard_states(2), 0);
}

TEST(Silence, ARestartOrAPauseIsNoLoss) {
  LossCount count;
  for (std::uint32_t sequence = 1; sequence < 10000; ++sequence) count.hear(sequence - 1, sequence);
  count.hear(9999, 0);
  count.hear(0, 5000);
  EXPECT_EQ(count.unheard_states(2), 0);
}

TEST(Silence, WhatItMayHaveDecidedTakesItFurtherAlongItsHeading) {
  const Limits limits{20, 40};
  const Commitment c{.stamp = 0,
                     .position = {0, 0},
                     .velocity = {18, 0},
                     .turn = 0.05,
                     .next_velocity = {20, 0},
                     .expiry = 0.1};
  const std::vector<Point2> rests = rests_after(c, limits, period, 3, 1.25);
  EXPECT_EQ(rests.front(), rest_after(c, limits, period));
  // Three more periods at full speed, before it brakes: 3 m.
  EXPECT_NEAR(rests.back().x() - rests.front().x(), 3, 1e-9);
  for (std::size_t k = 1; k < rests.size(); ++k) {
    EXPECT_GT(rests[k].x(), rests[k - 1].x());
    EXPECT_LE(rests[k].x() - rests[k - 1].x(), 1.25 + 1e-9);
  }
  EXPECT_EQ(rests_after(c, limits, period, 0, 1.25).size(), 1u);
}

TEST(Silence, OneThatStandsStaysWhereItIs) {
  const Commitment standing{.position = {3, 4}, .expiry = 1};
  EXPECT_EQ(rests_after(standing, {20, 40}, period, 10, 1).size(), 1u);
}

}  // namespace
}  // namespace coppice
