// Where a robot may stand that has fallen silent, and how much of what it decided may have reached nobody.
#include <gtest/gtest.h>

#include "motion/promise.h"
#include "robot_agent/fleet.h"
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
  EXPECT_EQ(none.unheard_states(1), 2);
  EXPECT_EQ(none.unheard_states(3), 0);
}

TEST(Silence, ARestartOrAPauseIsNoLoss) {
  LossCount count;
  for (std::uint32_t sequence = 1; sequence < 10000; ++sequence) count.hear(sequence - 1, sequence);
  count.hear(9999, 0);
  count.hear(0, 5000);
  EXPECT_EQ(count.unheard_states(3), 0);
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

/// A robot "a" that may hear "b" and "c".
class Listener {
 public:
  explicit Listener(std::vector<RobotName> others = {"b", "c"})
      : field_(OccupancyMap{.width = 200, .height = 200, .blocked = std::vector<std::uint8_t>(40000, 0)}) {
    others.push_back("a");
    for (const RobotName& robot : others)
      fleet_.hear(Mission{.robot = robot,
                          .start = {20, 20},
                          .goal = {30, 30},
                          .radius = 5,
                          .max_speed = 20,
                          .max_acceleration = 40,
                          .clock = {}},
                  0);
  }
  void hear(const RobotName& robot, double stamp, std::vector<Echo> echoes = {},
            const Point2& velocity = Point2::Zero()) {
    const RobotState state{.robot = robot,
                           .stamp = stamp,
                           .position = {100, 100},
                           .velocity = velocity,
                           .radius = 5,
                           .max_speed = 20,
                           .max_acceleration = 40,
                           .promise = {stamp + period, velocity, stamp + 2 * period},
                           .knot = {},
                           .echoes = std::move(echoes)};
    fleet_.hear(std::make_shared<const RobotState>(state), stamp + 0.001);
  }
  void judge(double now) { fleet_.judge_silence(now, {20, 20}, field_); }
  bool dead(const RobotName& robot) const { return fleet_.find(robot)->dead; }
  bool cut_off() const { return fleet_.cut_off(); }
  std::vector<Disc> dead_seen_from(const Point2& position, double now) const {
    return fleet_.places_of_the_dead(position, now);
  }

 private:
  ClearanceField field_;
  Fleet fleet_{"a"};
};

TEST(Silence, WhomOthersHearIsNotDeadAndNobodyMovesPastIt) {
  Listener a;
  double now = 0;
  const auto go_on_until = [&](double end, bool c_hears_b) {
    for (; now < end; now += period) {
      a.hear("c", now, c_hears_b ? std::vector<Echo>{{"b", now - 0.1, now}} : std::vector<Echo>{});
      a.judge(now);
    }
  };
  a.hear("b", now);
  go_on_until(1, true);
  EXPECT_FALSE(a.cut_off());
  go_on_until(20, true);  // from b itself there is nothing any more
  EXPECT_FALSE(a.dead("b"));
  EXPECT_TRUE(a.cut_off());
  go_on_until(25, false);
  EXPECT_TRUE(a.dead("b"));
  EXPECT_FALSE(a.cut_off());
}

TEST(Silence, WhoIsHeardByNobodyStands) {
  Listener a;
  for (double now = 0; now < 8; now += period) {
    a.hear("b", now, {{"a", std::min(now, 5.0) - 0.01, now}});
    a.hear("c", now);
    a.judge(now);
    EXPECT_EQ(a.cut_off(), now - 4.99 > 1.5) << now;
  }
}

TEST(Silence, TheSmallerPieceStandsUntilItHearsOfTheLarger) {
  Listener a({"b", "c", "d", "e"});
  double now = 0;
  const auto go_on_until = [&](double end, const std::vector<RobotName>& heard) {
    for (; now < end; now += period) {
      for (const RobotName& robot : heard) a.hear(robot, now);
      a.judge(now);
    }
  };
  go_on_until(1, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
  go_on_until(40, {"b"});
  EXPECT_TRUE(a.dead("c"));
  EXPECT_TRUE(a.cut_off());
  go_on_until(45, {});  // one of its own piece dies: that changes nothing
  EXPECT_TRUE(a.dead("b"));
  EXPECT_TRUE(a.cut_off());
  go_on_until(46, {"b"});
  EXPECT_TRUE(a.cut_off());
  go_on_until(47, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
}

TEST(Silence, WhomNobodyHeardEverIsDeadAfterTheMuster) {
  Listener a;
  for (double now = 0; now < 9.5; now += period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_FALSE(a.dead("b"));
  for (double now = 9.5; now < 11; now += period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_TRUE(a.dead("b"));
}

TEST(Silence, WhereALivingRobotStandsNoDeadOneDoesAndAPlanMayLeadOutFromCloseToIt) {
  Listener a({"b"});
  a.hear("b", 0, {}, {0, 10});
  for (double now = 0; now < 5; now += period) a.judge(now);
  ASSERT_TRUE(a.dead("b"));
  const std::vector<Disc> all = a.dead_seen_from({20, 20}, 5);
  ASSERT_GT(all.size(), 3u);
  for (const Disc& disc : all) EXPECT_EQ(disc.radius, 5);

  const Point2 last = all.back().centre;
  const std::vector<Disc> close = a.dead_seen_from(last + Point2(0, 10.0005), 5);
  ASSERT_EQ(close.size(), all.size());
  EXPECT_LT(close.back().radius, 5 - 0.0005);
  EXPECT_GT(close.back().radius, 4.999);
  const std::vector<Disc> within = a.dead_seen_from(last + Point2(0, 9.99), 5);
  EXPECT_EQ(within.size(), all.size() - 1);
}

}  // namespace
}  // namespace coppice
