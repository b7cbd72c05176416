// Tests of which peers count as silent, and of where a silent robot may stand.
#include <algorithm>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "messages/validation.h"
#include "motion/body/promise.h"
#include "planning/quantities.h"
#include "robot_agent/timing.h"
#include "tests/unit/robot_agent/listener.h"

namespace coppice {
namespace {

/// The sender has just heard "a". So "a" knows the clock of the sender, and how old its states are.
std::vector<Echo> heard_a(double now) {
  return {{"a", now - 0.01, now}};
}

TEST(FailureDetector, UnheardDecisionsExtendTheZoneAlongTheHeading) {
  const Limits limits{20, 40};
  const Promise c{.stamp = 0,
                  .position = {0, 0},
                  .velocity = {18, 0},
                  .decision_time = 0.05,
                  .next_velocity = {20, 0},
                  .expiry = 0.1};
  const std::vector<Point2> rests = rests_after(c, limits, period, 3, 1.25);
  EXPECT_EQ(rests.front(), rest_after(c, limits, period));
  // Three more periods at full speed before it brakes: 3 m.
  EXPECT_NEAR(rests.back().x() - rests.front().x(), 3, 1e-9);
  for (std::size_t k = 1; k < rests.size(); ++k) {
    EXPECT_GT(rests[k].x(), rests[k - 1].x());
    EXPECT_LE(rests[k].x() - rests[k - 1].x(), 1.25 + 1e-9);
  }
  EXPECT_EQ(rests_after(c, limits, period, 0, 1.25).size(), 1u);
}

TEST(FailureDetector, AStandingRobotStaysWhereItIs) {
  const Promise standing{.position = {3, 4}, .expiry = 1};
  EXPECT_EQ(rests_after(standing, {20, 40}, period, 10, 1).size(), 1u);
}

TEST(FailureDetector, APeerThatOthersHearIsNotDeclaredFailed) {
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
  go_on_until(20, true);  // b itself is not heard any more
  EXPECT_FALSE(a.failed("b"));
  EXPECT_TRUE(a.cut_off());
  go_on_until(25, false);
  EXPECT_TRUE(a.failed("b"));
  EXPECT_FALSE(a.cut_off());
}

TEST(FailureDetector, ARobotThatNobodyHearsStands) {
  Listener a;
  for (double now = 0; now < 8; now += period) {
    a.hear("b", now, {{"a", std::min(now, 5.0) - 0.01, now}});
    a.hear("c", now);
    a.judge(now);
    EXPECT_EQ(a.cut_off(), now - 4.99 > 1.8) << now;
  }
}

// Peers that do not know the echoing robot take this one for cut off from all, and count on it to stand. With
// clocks 46 s apart and a partition two robots overlapped by 2.85 m (coppice fuzz --replay 49700586).
TEST(FailureDetector, AnEchoOfARobotThatSomePeerMayNotKnowIsNoContact) {
  Listener a;
  for (double now = 0; now < 8; now += period) {
    RobotState late = state_of("b", now, {100, 100});
    late.echoes = {{"a", now - 0.01, now}};
    late.may_be_unknown = true;
    a.hear(late);
    a.hear("c", now, {{"a", std::min(now, 5.0) - 0.01, now}});
    a.judge(now);
    EXPECT_EQ(a.cut_off(), now - 4.99 > 1.8) << now;
  }
}

TEST(FailureDetector, ARobotIsKnownToAllWhenEachPeerHasHeardItSinceItWasOutOfTouch) {
  Listener a;
  const auto hear_both = [&](double now, double heard_by_b, double heard_by_c) {
    a.hear("b", now, {{"a", heard_by_b, now}});
    a.hear("c", now, {{"a", heard_by_c, now}});
    a.judge(now);
  };
  a.judge(0);
  EXPECT_TRUE(a.may_be_unknown());
  hear_both(0.1, 0.05, 0);
  EXPECT_TRUE(a.may_be_unknown()) << "c has not heard it";
  hear_both(0.2, 0.15, 0.15);
  EXPECT_FALSE(a.may_be_unknown());
  double now = 0.25;
  for (; now < 3; now += period) a.judge(now);
  EXPECT_TRUE(a.may_be_unknown()) << "both may have given it up";
  hear_both(now, now - 0.01, 0.15);
  hear_both(now + period, now + period - 0.01, 0.15);
  EXPECT_TRUE(a.may_be_unknown()) << "c has not heard that it is back";
  now += 2 * period;
  hear_both(now, now - 0.01, now - 0.01);
  hear_both(now + period, now, now);
  EXPECT_FALSE(a.may_be_unknown());
}

// The peer may only be cut off. It then drives on until it misses the others.
TEST(FailureDetector, TheReachableSetOfASinglySilentPeerIsKeptClearForAMinute) {
  Listener a;
  a.hear("b", 1);
  const double braking = 20 * 20 / (2 * 40.0);
  for (double now = 1; now < 70; now += period) {
    a.hear("c", now, {}, Point2::Zero(), {20, 20});
    a.judge(now);
    if (now > 3.2 && now < 61) {
      ASSERT_TRUE(a.failed("b")) << now;
      ASSERT_TRUE(a.is_suspected_near({150, 100})) << now;
      ASSERT_GT(a.kept_clear_around("b", now), 5 + 2 * 20 + braking) << now;
    } else if (now > 61.1) {
      ASSERT_FALSE(a.is_suspected_near({100, 100})) << now;
      ASSERT_EQ(a.kept_clear_around("b", now), 5) << now;
    }
  }
}

/// A standing robot that takes so many seconds to brake from full speed.
RobotState slow_to_brake(const RobotName& robot, double stamp, double braking) {
  RobotState state = state_of(robot, stamp, {100, 100});
  state.max_acceleration = state.max_speed / braking;
  return state;
}

/// The robots `silent` are heard once. They are kept clear of until they must have braked, if they drove on
/// for as long as it takes a robot to notice that nobody hears it, and count as failed only then. `from`:
/// seconds after which they are suspected.
void expect_kept_clear_until_braked(Listener& a, const std::vector<RobotName>& silent,
                                    const std::vector<RobotName>& heard, double braking, double from) {
  const double driven = Timing::longest_unheard + Timing::unheard_before;
  for (const RobotName& robot : silent) a.hear(slow_to_brake(robot, 0, braking));
  const double rests = driven + 2 * period + braking;
  const double latest = std::max(Timing::longest_partition, rests + Timing::largest_clock_error) + 0.2;
  const double strays = driven * 20 + 20 * braking / 2 - 20 * period;
  for (double now = 0; now < latest + 5; now += period) {
    for (const RobotName& robot : heard) a.hear(robot, now, {}, Point2::Zero(), {20, 20});
    a.judge(now);
    for (const RobotName& robot : silent) {
      if (now > from && now < rests) {
        ASSERT_TRUE(a.failed(robot)) << robot << " at " << now;
        ASSERT_TRUE(a.is_suspected_near({100 + strays, 100})) << robot << " at " << now;
        ASSERT_GT(a.kept_clear_around(robot, now), 5 + strays) << robot << " at " << now;
        ASSERT_EQ(a.recoveries(), 0u) << robot << " at " << now;
      } else if (now > latest + 0.1) {
        ASSERT_TRUE(a.failed(robot)) << robot << " at " << now;
        ASSERT_FALSE(a.is_suspected_near({100, 100})) << robot << " at " << now;
        ASSERT_LT(a.kept_clear_around(robot, now), 5.01) << robot << " at " << now;
        ASSERT_EQ(a.recoveries(), silent.size()) << robot << " at " << now;
      }
    }
  }
}

// The peer may brake for longer than a network is in pieces. Its disc shrank to a point while it still drove.
TEST(FailureDetector, ASuspectedPeerThatBrakesForLongIsKeptClearOfUntilItMustHaveBraked) {
  for (const double braking : {60.0, 100.0}) {
    Listener a;
    expect_kept_clear_until_braked(a, {"b"}, {"c"}, braking, 3.2);
  }
}

TEST(FailureDetector, SeveralSilentPeersThatBrakeForLongAreKeptClearOfUntilTheyMustHaveBraked) {
  for (const double braking : {60.0, 100.0}) {
    Listener a({"b", "c", "d", "e"});
    expect_kept_clear_until_braked(a, {"d", "e"}, {"b", "c"}, braking, Timing::longest_partition + 0.2);
  }
}

TEST(FailureDetector, APeerThatWasNeverHeardIsDeclaredFailedAfterTheBarrier) {
  Listener a;
  for (double now = 0; now < 9.5; now += period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_FALSE(a.failed("b"));
  for (double now = 9.5; now < 11; now += period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_TRUE(a.failed("b"));
}

// A robot sends often to a peer that it does not know yet, at any distance.
TEST(FailureDetector, ADistantPeerThatNeverCameDelaysNobodyLonger) {
  Listener a;
  a.hear_mission("b", {9000, 9000});
  for (double now = 0; now < 11; now += period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_TRUE(a.failed("b"));
}

TEST(FailureDetector, TheZoneExcludesLivingRobotsAndAPlanMayLeadOutOfIt) {
  Listener a;
  a.hear("b", 0, {}, {0, 10});
  for (double now = 0; now < 5; now += period) {
    a.hear("c", now, heard_a(now), Point2::Zero(), {20, 100});
    a.judge(now);
  }
  ASSERT_TRUE(a.failed("b"));
  const std::vector<Disc> all = a.failed_seen_from({20, 20}, 5);
  ASSERT_GT(all.size(), 3u);
  for (const Disc& disc : all) EXPECT_NEAR(disc.radius, 5.002, 0.002);

  const Point2 last = all.back().centre;
  const std::vector<Disc> close = a.failed_seen_from(last + Point2(0, 10.0005), 5);
  ASSERT_EQ(close.size(), all.size());
  EXPECT_LT(close.back().radius, 5 - 0.0005);
  EXPECT_GT(close.back().radius, 4.999);
  a.hear("c", 5, heard_a(5), Point2::Zero(), last + Point2(0, 9.99));
  for (double now = 5; now < 6; now += period) a.judge(now);
  const std::vector<Disc> left = a.failed_seen_from({20, 20}, 6);
  EXPECT_NEAR((left.back().centre - (last + Point2(0, 9.99))).norm(), 10, 0.009) << "as near as it can stand";
}

// Plans are kept for late readers. An old one may lead through where a robot has failed since.
TEST(FailureDetector, OnlyAPlanThatWasMadeLongAfterAFailureShowsWhereTheRobotDoesNotStand) {
  const auto discs_after_a_plan_that_departs_at = [](double departure) {
    Listener a;
    a.hear("b", 0, {}, {0, 10});
    for (double now = 0; now < 5; now += period) {
      a.hear("c", now, heard_a(now), Point2::Zero(), {20, 100});
      a.judge(now);
    }
    const Point2 last = a.failed_seen_from({20, 20}, 5).back().centre;
    JointPlanMessage plan{.round = {1, "c"}, .members = {{.robot = "c", .radius = 5}}, .run = {}};
    plan.members.front().trajectory = {{departure, last - Point2(50, 0)},
                                       {departure + 5, last + Point2(50, 0)}};
    a.hear(plan);
    return a.failed_seen_from({20, 20}, 5).size();
  };
  const std::size_t all = discs_after_a_plan_that_departs_at(-10);
  EXPECT_EQ(discs_after_a_plan_that_departs_at(30), all);
  EXPECT_LT(discs_after_a_plan_that_departs_at(300), all);
}

/// The zone of "b", which failed while it drove upwards, while "c" stands at `c`.
std::vector<Disc> places_of_b(const Point2& c) {
  Listener a;
  a.hear("b", 0, {}, {0, 10});
  for (double now = 0; now < 5; now += period) {
    a.hear("c", now, heard_a(now), Point2::Zero(), c);
    a.judge(now);
  }
  return a.failed_seen_from({20, 20}, 5);
}

// The robot could be touched between the discs that were kept clear: by 0.5 m where a robot stood before it,
// and by millimetres between two discs.
TEST(FailureDetector, TheZoneCoversEveryPositionOfAFailedRobot) {
  const std::vector<Disc> all = places_of_b({20, 100});
  for (std::size_t k = 1; k < all.size(); ++k) {
    const double apart = (all[k].centre - all[k - 1].centre).norm();
    const double touching = 5 + std::min(all[k].radius, all[k - 1].radius);
    EXPECT_GE(std::sqrt(touching * touching - apart * apart / 4), 10 - 1e-9) << k;
  }
  const double length = (all.back().centre - all.front().centre).norm();
  ASSERT_GT(length, 1);
  for (const double share : {0.33, 0.61, 0.87}) {
    const Point2 ahead = all.front().centre + Point2(0, share * length + 10);
    const std::vector<Disc> some = places_of_b(ahead);
    EXPECT_NEAR((ahead - some.back().centre).norm(), 10, 0.02) << share;
  }
}

TEST(FailureDetector, ARobotBesideAFailedOneAddsNoDiscsToItsZone) {
  const std::vector<Disc> all = places_of_b({20, 100});
  for (const double along : {-1.0, 0.0, 0.3, 1.2}) {
    Listener a;
    a.hear("b", 0, {}, {0, 10});
    const Point2 beside = all.front().centre + Point2(9.9, along);
    for (double now = 0; now < 65; now += period) {
      a.hear("c", now, heard_a(now), Point2::Zero(), now < 5 ? Point2(20, 100) : beside);
      a.judge(now);
    }
    EXPECT_LE(a.failed_seen_from({20, 20}, 65).size(), all.size() + 2) << along;
  }
}

/// "a" hears "b" once, and "c" for as long as the test says.
struct ZoneOfB {
  /// It brakes from full speed in 4 s, and from this one in 1 s.
  static constexpr double speed = 5;
  static constexpr double braking = 4;
  /// So many decisions may have reached nobody: half of the states are lost, and two listen.
  static constexpr int unheard = 9;

  Listener a{};
  double now = 0;

  ZoneOfB() {
    RobotState last = state_of("b", 0, {100, 100}, {0, speed});
    last.max_acceleration = last.max_speed / braking;
    a.hear(last);
  }
  /// "c" stands at `place` until `end`.
  void go_on_until(double end, const Point2& place) {
    for (; now < end; now += period) {
      a.hear("c", now, heard_a(now), Point2::Zero(), place);
      a.judge(now);
    }
  }
  std::vector<Disc> zone() const { return a.failed_seen_from({20, 20}, now); }
};

constexpr double sure_to_stand = (2 + ZoneOfB::unheard) * period + ZoneOfB::braking;  // seconds
const Point2 elsewhere{20, 100};

// A robot may pass where a failed one comes to rest later.
TEST(FailureDetector, ARobotThatWasThereBeforeTheFailedOneStoodDoesNotShortenTheZone) {
  ZoneOfB undisturbed;
  undisturbed.go_on_until(8, elsewhere);
  const std::vector<Disc> all = undisturbed.zone();
  ASSERT_GT(all.size(), 3u);
  const Point2 there = all.back().centre + Point2(0, 9.5);
  // Without the decisions that nobody heard the robot would stand half a second earlier.
  for (const double until : {3.0, 4.0, braking_time({20, 5}) + 2 * period + 0.3, sure_to_stand - period}) {
    ZoneOfB passed;
    passed.go_on_until(until, there);
    ASSERT_TRUE(passed.a.failed("b")) << until;
    passed.go_on_until(8, elsewhere);
    EXPECT_EQ(passed.zone().size(), all.size()) << until;
    EXPECT_EQ(passed.zone().back().centre, all.back().centre) << until;
  }
  ZoneOfB stayed;
  stayed.go_on_until(sure_to_stand + 1, there);
  stayed.go_on_until(8, elsewhere);
  EXPECT_NEAR((there - stayed.zone().back().centre).norm(), 10, 0.02) << "as near as it can stand";
}

// An agent that was started in mid-run had counted nothing, and took the loss for the largest possible. The
// zone of the failed robot covered the goal.
TEST(FailureDetector, AnAgentThatHasCountedLittleTakesThePeersWordForTheCopies) {
  const auto places = [](std::uint8_t copies) {
    Listener a;
    RobotState last = state_of("b", 0, {100, 100}, {0, 10});
    last.copies = copies;
    a.hear(last);
    for (double now = 0; now < 5; now += period) {
      a.hear("c", now, {}, Point2::Zero(), {20, 100});
      a.judge(now);
    }
    EXPECT_TRUE(a.failed("b"));
    return a.failed_seen_from({20, 20}, 5).size();
  };
  EXPECT_GT(places(1), 1u) << "b sends as if it were alone";
  EXPECT_EQ(places(2), 1u);
  EXPECT_EQ(places(Timing::most_copies - 1), 1u);
}

TEST(FailureDetector, TheZoneOfARobotOfImpossibleSpeedIsComputedQuickly) {
  Listener a;
  RobotState absurd{.robot = "b",
                    .promise = {.stamp = 0,
                                .position = {100, 100},
                                .velocity = {1e9, 0},
                                .decision_time = period,
                                .next_velocity = {1e9, 0},
                                .expiry = 2 * period},
                    .radius = least_quantity,
                    .max_speed = 1e9,
                    .max_acceleration = 1e7,
                    .round = {},
                    .echoes = {}};
  ASSERT_FALSE(problem_with(absurd));
  a.hear(absurd);
  double now = 0;
  for (; now < 200; now += 20 * period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_TRUE(a.failed("b"));
  EXPECT_FALSE(a.failed_seen_from({80, 80}, now).empty());
}

}  // namespace
}  // namespace coppice
