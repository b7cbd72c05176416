// Where a robot may stand that has fallen silent, and how much of what it decided may have reached nobody.
#include <optional>

#include <gtest/gtest.h>

#include "bus/validation.h"
#include "motion/promise.h"
#include "planning/quantities.h"
#include "robot_agent/fleet.h"
#include "robot_agent/loss.h"

namespace coppice {
namespace {

constexpr double period = 0.05;

/// The count after states of these beats came, in this order.
LossCount counted(const std::vector<std::uint32_t>& numbers) {
  LossCount loss;
  Received received;
  for (const std::uint32_t number : numbers) loss.add(received.hear(number * standing_stride));
  return loss;
}

std::vector<std::uint32_t> numbers_up_to(std::uint32_t end, auto&& came) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t k = 0; k < end; ++k) {
    if (came(k)) numbers.push_back(k);
  }
  return numbers;
}

TEST(Silence, StatesLostToAllBecomeRareWithTheirNumberAndThatOfTheWitnesses) {
  const LossCount two_thirds = counted(numbers_up_to(3000, [](auto k) { return k % 6 < 2; }));
  // But more than half is never taken as what goes on.
  EXPECT_EQ(two_thirds.unheard_states(1), 19);  // 0.5^20 is the first below one in a million
  EXPECT_EQ(two_thirds.unheard_states(10), 1);
  EXPECT_EQ(two_thirds.unheard_states(20), 0);

  const LossCount tenth = counted(numbers_up_to(3000, [](auto k) { return k % 10 != 0; }));
  EXPECT_EQ(tenth.unheard_states(1), 6);

  const LossCount none = counted(numbers_up_to(10000, [](auto) { return true; }));
  EXPECT_EQ(none.unheard_states(1), 2);
  EXPECT_EQ(none.unheard_states(3), 0);
}

TEST(Silence, WhatIsSaidOftenEnoughIsNeverLostOnAllWays) {
  for (const std::uint32_t lost : {0u, 1u, 3u, 5u}) {  // of ten
    const LossCount loss =
        counted(numbers_up_to(3000, [&](auto k) { return (k * 7 + k / 10) % 10 >= lost; }));
    for (std::size_t listeners = 1; listeners <= 6; ++listeners) {
      const int copies = loss.copies_for(listeners);
      EXPECT_GE(copies, 1);
      if (copies < 16) {
        EXPECT_EQ(loss.unheard_states(listeners * static_cast<std::size_t>(copies)), 0) << lost;
      }
      if (copies > 1) {
        EXPECT_GT(loss.unheard_states(listeners * static_cast<std::size_t>(copies - 1)), 0) << lost;
      }
    }
  }
  const LossCount none = counted(numbers_up_to(3000, [](auto) { return true; }));
  EXPECT_EQ(none.copies_for(3), 1);  // which costs nothing in a fleet of any size
}

TEST(Silence, ARestartOrAPauseIsNoLossNorIsWhatComesLateOrTwice) {
  std::vector<std::uint32_t> numbers = numbers_up_to(10000, [](auto) { return true; });
  for (std::size_t k = 0; k + 7 < numbers.size(); k += 7) {
    std::swap(numbers[k], numbers[k + 5]);
    numbers[k + 6] = numbers[k + 3];
    numbers[k + 3] += 3;  // comes in its place, the other once more
  }
  for (std::uint32_t k = 0; k < 100; ++k) numbers.push_back(k);
  for (std::uint32_t k = 5000; k < 5100; ++k) numbers.push_back(k);
  EXPECT_EQ(counted(numbers).unheard_states(1), 2);
}

TEST(Silence, WhoIsHeardOfFromTimeToTimeOnlyTellsNothingAboutLoss) {
  for (const std::uint32_t stride : {2u, 4u, 8u, 16u}) {
    const LossCount loss = counted(numbers_up_to(5000, [&](auto k) { return k % stride == 0; }));
    EXPECT_EQ(loss.unheard_states(1), LossCount().unheard_states(1));
  }
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
  explicit Listener(std::vector<RobotName> others = {"b", "c"}, const RobotName& self = "a")
      : field_(OccupancyMap{.width = 200, .height = 200, .blocked = std::vector<std::uint8_t>(40000, 0)}),
        fleet_(self) {
    others.push_back(self);
    for (const RobotName& robot : others) hear_mission(robot, {70, 70});
  }
  void hear_mission(const RobotName& robot, const Point2& start) {
    fleet_.hear(Mission{.robot = robot,
                        .start = start,
                        .goal = {30, 30},
                        .radius = 5,
                        .max_speed = 20,
                        .max_acceleration = 40,
                        .clock = {}},
                0);
  }
  void hear(const RobotName& robot, double stamp, std::vector<Echo> echoes = {},
            const Point2& velocity = Point2::Zero(), const Point2& position = {100, 100}) {
    const RobotState state{.robot = robot,
                           .stamp = stamp,
                           .position = position,
                           .velocity = velocity,
                           .radius = 5,
                           .max_speed = 20,
                           .max_acceleration = 40,
                           .promise = {stamp + period, velocity, stamp + 2 * period},
                           .knot = {},
                           .echoes = std::move(echoes)};
    fleet_.hear(std::make_shared<const RobotState>(state), stamp + 0.001);
  }
  void hear(const RobotState& state) {
    fleet_.hear(std::make_shared<const RobotState>(state), state.stamp + 0.001);
  }
  /// What somebody says to be the last state of `robot`; false if it was not taken up.
  bool hear_passed_on(const RobotName& robot, double stamp, double now, const Point2& position) {
    const RobotState state{.robot = robot,
                           .stamp = stamp,
                           .position = position,
                           .radius = 5,
                           .max_speed = 20,
                           .max_acceleration = 40,
                           .promise = {stamp + period, Point2::Zero(), stamp + 2 * period},
                           .knot = {},
                           .passed_on = true,
                           .echoes = {}};
    return fleet_.hear(std::make_shared<const RobotState>(state), now);
  }
  double now() const { return now_; }
  std::size_t others() const { return fleet_.others().size(); }
  bool echoed(double now) const { return fleet_.echoed(now); }
  Point2 place(const RobotName& robot) const { return fleet_.find(robot)->position; }
  /// Everybody else is silent.
  void go_on_until(double end, const std::vector<RobotName>& heard) {
    for (; now_ < end; now_ += period) {
      for (const RobotName& robot : heard) hear(robot, now_);
      judge(now_);
    }
  }
  void judge(double now) { fleet_.judge_silence(now, {80, 80}, {}, field_); }
  bool dead(const RobotName& robot) const { return fleet_.find(robot)->dead; }
  bool doubts(const Point2& p) const { return fleet_.doubts(p, 0); }
  /// Metres around `robot` that are kept clear; none: 0.
  double kept_clear_around(const RobotName& robot, double now) {
    AgeCount ages;
    std::vector<Neighbour> near;
    fleet_.collect_neighbours({80, 80}, 100, 10, now, ages, near);
    double radius = 0;
    for (const Neighbour& n : near) {
      if ((n.commitment.position - place(robot)).norm() < 1e-9) radius = std::max(radius, n.radius);
    }
    return radius;
  }
  std::vector<RobotName> who_missed_the_news(double now) const { return fleet_.who_missed_the_news(now); }
  bool cut_off() const { return fleet_.cut_off(); }
  std::vector<Disc> dead_seen_from(const Point2& position, double now) const {
    return fleet_.places_of_the_dead(position, now);
  }

 private:
  ClearanceField field_;
  Fleet fleet_;
  double now_ = 0;
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
    EXPECT_EQ(a.cut_off(), now - 4.99 > 1.8) << now;
  }
}

TEST(Silence, TheSmallerPieceStandsUntilItHearsOfTheLarger) {
  Listener a({"b", "c", "d", "e"});
  a.go_on_until(1, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
  a.go_on_until(60, {"b"});
  EXPECT_FALSE(a.dead("c"));
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(65, {"b"});
  EXPECT_TRUE(a.dead("c"));
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(70, {});  // one of its own piece dies: that changes nothing
  EXPECT_TRUE(a.dead("b"));
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(71, {"b"});
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(72, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
}

// Nor where what is left of its piece would, by names, be the one to go on after a minute.
TEST(Silence, TheSmallerPieceStandsForAsLongWhereTheFirstOfItDies) {
  Listener b({"a", "c", "d", "e"}, "b");
  b.go_on_until(1, {"a", "c", "d", "e"});
  b.go_on_until(65, {"a"});
  EXPECT_TRUE(b.dead("c"));
  EXPECT_TRUE(b.cut_off());
  b.go_on_until(140, {});
  EXPECT_TRUE(b.dead("a"));
  EXPECT_TRUE(b.cut_off());
  b.go_on_until(141, {"c", "d", "e"});
  EXPECT_FALSE(b.cut_off());
}

// Who was never started is no part of a network in pieces, once that would have healed.
TEST(Silence, TwoThatDieAtOnceStopNobodyHoweverManyNeverCame) {
  Listener a({"b", "c", "d", "e", "f", "g", "h", "i", "j"});
  a.go_on_until(12, {"b", "c", "d", "e"});
  EXPECT_TRUE(a.dead("j"));
  a.go_on_until(200, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
  a.go_on_until(265, {"b", "c"});
  EXPECT_TRUE(a.dead("d"));
  EXPECT_FALSE(a.cut_off());
}

TEST(Silence, WhoStandsInAnothersWayMayGoElsewhere) {
  Fleet fleet("a");
  Mission mission{.robot = "b", .number = 1, .clock = {}};
  fleet.hear(mission, 0);
  mission.cancelled = true;
  fleet.hear(mission, 1);
  EXPECT_EQ(fleet.new_goals(), 0u);
  mission.number = 2;
  fleet.hear(mission, 2);
  EXPECT_EQ(fleet.new_goals(), 1u);
}

TEST(Silence, NobodyWaitsThatOneThatWasStoppedHolds) {
  Fleet fleet("a");
  fleet.hear(Mission{.robot = "a", .clock = {}}, 0);
  const KnotId knot{1, "a", {100, 100}, 50};
  const auto says = [&](const char* robot, Phase phase, double stamp) {
    RobotState state{.robot = robot, .stamp = stamp, .position = {100, 100}, .radius = 5, .knot = {}};
    state.phase = phase;
    fleet.hear(std::make_shared<const RobotState>(state), stamp);
  };
  says("b", Phase::driving, 1);
  EXPECT_FALSE(fleet.all_hold(knot));
  says("b", Phase::stopped, 2);
  EXPECT_TRUE(fleet.all_hold(knot));
}

// It may only be cut off, and drives on until it misses the others.
TEST(Silence, OfOneThatIsSilentAloneAllItMayReachIsKeptClearForAMinute) {
  Listener a;
  a.hear("b", 1);
  const double braking = 20 * 20 / (2 * 40.0);
  for (double now = 1; now < 70; now += period) {
    a.hear("c", now, {}, Point2::Zero(), {20, 20});
    a.judge(now);
    if (now > 3.2 && now < 61) {
      ASSERT_TRUE(a.dead("b")) << now;
      ASSERT_TRUE(a.doubts({150, 100})) << now;
      ASSERT_GT(a.kept_clear_around("b", now), 5 + 2 * 20 + braking) << now;
    } else if (now > 61.1) {
      ASSERT_FALSE(a.doubts({100, 100})) << now;
      ASSERT_EQ(a.kept_clear_around("b", now), 5) << now;
    }
  }
}

// Another that is far away speaks rarely: it may have fallen silent with this one.
TEST(Silence, NobodyIsSilentAloneBeforeAllOthersHaveSaidSomething) {
  Listener a;
  const Point2 far{1900, 1900};
  for (double now = 0; now < 1; now += period) {
    a.hear("b", now);
    a.hear("c", now, {}, Point2::Zero(), far);
    a.judge(now);
  }
  for (double now = 1; now < 4; now += period) a.judge(now);
  EXPECT_FALSE(a.dead("b"));
  a.hear("c", 4, {}, Point2::Zero(), far);
  for (double now = 4; now < 5; now += period) a.judge(now);
  EXPECT_TRUE(a.dead("b"));
  EXPECT_FALSE(a.dead("c"));
}

// A cut would have silenced both: how far one drove on is asked of the later one alone.
TEST(Silence, WhoFellSilentBeforeAnotherIsNotInAPieceWithIt) {
  Listener a;
  double now = 0;
  for (; now < 1.8; now += period) {
    if (now < 1) a.hear("b", now, {}, {10, 0}, {40 + 10 * now, 110});
    a.hear("c", now, {}, {10, 0}, {40 + 10 * now, 50});
    a.judge(now);
  }
  for (; now < 130; now += period) a.judge(now);
  ASSERT_TRUE(a.dead("b") && a.dead("c"));
  double furthest_b = 0;
  double furthest_c = 0;
  for (const Disc& disc : a.dead_seen_from({80, 80}, now)) {
    double& furthest = disc.centre.y() > 80 ? furthest_b : furthest_c;
    furthest = std::max(furthest, disc.centre.x());
  }
  EXPECT_LT(furthest_b, 40 + 10 * 1 + 20 * 1.5);
  EXPECT_GT(furthest_c, 40 + 10 * 1.8 + 20 * 2.5);
}

TEST(Silence, OfTwoThatMissEachOtherTheLaterNameStandsForAMinute) {
  Listener a({"A"});
  Listener first({"b"});
  for (double now = 0; now < 70; now += period) {
    if (now < 1) a.hear("A", now);
    if (now < 1) first.hear("b", now);
    a.judge(now);
    first.judge(now);
    EXPECT_FALSE(first.cut_off()) << now;
    const bool turning = (now > 1.5 && now < 1.7) || (now > 60 && now < 65);
    if (!turning) {
      EXPECT_EQ(a.cut_off(), now > 1.6 && now < 62) << now;
    }
  }
}

// It was not told what the others learnt meanwhile, nor they what it did.
TEST(Silence, AfterSomebodyCameBackNobodyIsTakenForDeadUntilItHasHeardTheNews) {
  Listener a;
  a.go_on_until(1, {"b", "c"});
  a.go_on_until(9, {"c"});
  EXPECT_TRUE(a.dead("b"));
  EXPECT_TRUE(a.who_missed_the_news(a.now()).empty());
  a.go_on_until(10.5, {});
  a.go_on_until(13, {"b"});  // c would be dead by now
  EXPECT_FALSE(a.dead("c"));
  EXPECT_EQ(a.who_missed_the_news(a.now()), std::vector<RobotName>{"b"});
  a.go_on_until(14, {"b"});
  EXPECT_TRUE(a.dead("c"));
  EXPECT_TRUE(a.who_missed_the_news(a.now()).empty());
}

TEST(Silence, WhoIsFirstHeardOfWhenTheOthersAreUnderWayIsToldOfTheDead) {
  Listener a;
  for (double now = 0; now < 12; now += period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_TRUE(a.who_missed_the_news(12).empty());
  a.hear("b", 12);
  EXPECT_EQ(a.who_missed_the_news(12.1), std::vector<RobotName>{"b"});
}

// Agents outlive runs: one may still speak of the last one when another has begun the next.
TEST(Silence, WhatWasSaidInTheRunBeforeIsForgotten) {
  Fleet fleet("a");
  const auto says = [&](WallTime run, double stamp) {
    return fleet.hear(std::make_shared<const RobotState>(RobotState{.robot = "b",
                                                                    .stamp = stamp,
                                                                    .position = {100, 100},
                                                                    .radius = 5,
                                                                    .promise = {stamp, Point2::Zero(), stamp},
                                                                    .knot = {},
                                                                    .run = run}),
                      run + stamp);
  };
  EXPECT_TRUE(says(100, 300));  // which run it is in is not known yet
  for (const char* robot : {"a", "b"})
    fleet.hear(Mission{.robot = robot, .start = {70, 70}, .radius = 5, .max_speed = 20, .clock = {500, 1}},
               500);
  EXPECT_EQ(fleet.find("b")->position, Point2(70, 70));
  EXPECT_FALSE(says(100, 400.1));
  EXPECT_EQ(fleet.find("b")->position, Point2(70, 70));
  EXPECT_TRUE(says(500, 0.1));
  EXPECT_EQ(fleet.find("b")->position, Point2(100, 100));
}

// An agent that was started between two runs has heard those of the first one that are not in the second.
TEST(Silence, WhoIsNotInTheRunIsNoNeighbour) {
  Fleet fleet("a");
  for (const char* robot : {"b", "c"})
    fleet.hear(std::make_shared<const RobotState>(RobotState{.robot = robot,
                                                             .stamp = 300,
                                                             .position = {100, 100},
                                                             .radius = 5,
                                                             .promise = {300, Point2::Zero(), 300},
                                                             .knot = {},
                                                             .run = 100}),
               400);
  for (const char* robot : {"a", "b"})
    fleet.hear(Mission{.robot = robot,
                       .start = {70, 70},
                       .radius = 5,
                       .max_speed = 20,
                       .max_acceleration = 40,
                       .clock = {500, 1}},
               500);
  AgeCount ages;
  std::vector<Neighbour> near;
  fleet.collect_neighbours({80, 80}, 100, 10, 0.1, ages, near);
  ASSERT_EQ(near.size(), 1u);
  EXPECT_EQ(near.front().commitment.position, Point2(70, 70));
  EXPECT_FALSE(fleet.complete(2));  // b has not been heard of
  fleet.hear(std::make_shared<const RobotState>(RobotState{.robot = "c",
                                                           .stamp = 301,
                                                           .position = {100, 100},
                                                           .radius = 5,
                                                           .promise = {301, Point2::Zero(), 301},
                                                           .knot = {},
                                                           .run = 100}),
             501);
  EXPECT_EQ(fleet.others().size(), 1u);
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

// Who does not know another yet speaks to it often, however far away it is.
TEST(Silence, WhoIsFarAwayAndNeverCameHoldsNobodyUpForLonger) {
  Listener a;
  a.hear_mission("b", {9000, 9000});
  for (double now = 0; now < 11; now += period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_TRUE(a.dead("b"));
}

TEST(Silence, WhereALivingRobotStandsNoDeadOneDoesAndAPlanMayLeadOutFromCloseToIt) {
  Listener a;
  a.hear("b", 0, {}, {0, 10});
  for (double now = 0; now < 5; now += period) {
    a.hear("c", now, {}, Point2::Zero(), {20, 100});
    a.judge(now);
  }
  ASSERT_TRUE(a.dead("b"));
  const std::vector<Disc> all = a.dead_seen_from({20, 20}, 5);
  ASSERT_GT(all.size(), 3u);
  for (const Disc& disc : all) EXPECT_EQ(disc.radius, 5);

  const Point2 last = all.back().centre;
  const std::vector<Disc> close = a.dead_seen_from(last + Point2(0, 10.0005), 5);
  ASSERT_EQ(close.size(), all.size());
  EXPECT_LT(close.back().radius, 5 - 0.0005);
  EXPECT_GT(close.back().radius, 4.999);
  a.hear("c", 5, {}, Point2::Zero(), last + Point2(0, 9.99));
  for (double now = 5; now < 6; now += period) a.judge(now);
  EXPECT_EQ(a.dead_seen_from({20, 20}, 6).size(), all.size() - 1);
}

TEST(Silence, NobodyHasHeardWhatIsStillToBeSaid) {
  Listener a;
  double now = 0;
  for (; now < 8; now += period) {
    a.hear("b", now, {{"a", 1e8, now}});
    a.hear("c", now, {{"a", std::min(now, 1.0) - 0.01, now}});
    a.judge(now);
  }
  EXPECT_FALSE(a.echoed(now));
  EXPECT_TRUE(a.cut_off());
}

TEST(Silence, AnEchoFromTheFutureOfAnotherTellsNothing) {
  Listener a;
  double now = 0;
  const auto go_on_until = [&](double end, std::optional<double> ahead) {
    for (; now < end; now += period) {
      std::vector<Echo> echoes{{"a", now - 0.01, now}};
      if (ahead) echoes.push_back({"b", now + *ahead, now});
      a.hear("c", now, echoes);
      a.judge(now);
    }
  };
  a.hear("b", 0, {{"a", -0.01, 0}});
  go_on_until(1.3, std::nullopt);  // b is missing
  go_on_until(1.5, 1e8);           // a lie
  go_on_until(10, -0.1);
  EXPECT_FALSE(a.dead("b"));  // others hear it still
  EXPECT_TRUE(a.cut_off());
}

TEST(Silence, WhatIsPassedOnReplacesNeitherWhatIsHeardNorComesFromTheFuture) {
  Listener a;
  for (double now = 0; now < 1; now += period) {
    a.hear("b", now, {{"a", now - 0.01, now}});
    EXPECT_FALSE(a.hear_passed_on("b", now + 0.02, now + 0.02, {10, 10}));
    a.judge(now);
  }
  EXPECT_EQ(a.place("b"), Point2(100, 100));
  EXPECT_FALSE(a.hear_passed_on("b", 1e6, 1.8, {10, 10}));
  EXPECT_TRUE(a.hear_passed_on("b", 1.1, 1.8, {90, 100}));  // it has said that before it fell silent
  EXPECT_EQ(a.place("b"), Point2(90, 100));
}

TEST(Silence, WhereADeadRobotOfImpossibleSpeedMayStandIsSoonSaid) {
  Listener a;
  RobotState absurd{.robot = "b",
                    .stamp = 0,
                    .position = {100, 100},
                    .velocity = {1e9, 0},
                    .radius = least_quantity,
                    .max_speed = 1e9,
                    .max_acceleration = 1e7,
                    .promise = {period, {1e9, 0}, 2 * period},
                    .knot = {},
                    .echoes = {}};
  ASSERT_FALSE(problem_with(absurd));
  a.hear(absurd);
  double now = 0;
  for (; now < 200; now += 20 * period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_TRUE(a.dead("b"));
  EXPECT_FALSE(a.dead_seen_from({80, 80}, now).empty());
}

TEST(Silence, AFleetHasNoMoreRobotsThanItMayHave) {
  Listener a;
  for (std::size_t k = 0; k < 2 * most_robots; ++k) a.hear("x" + std::to_string(k), 0);
  EXPECT_EQ(a.others(), most_robots);
  a.hear("b", 1, {}, Point2::Zero(), {50, 50});  // who is known stays
  EXPECT_EQ(a.place("b"), Point2(50, 50));
}

}  // namespace
}  // namespace coppice
