// Networks in pieces: who goes on, who stands for how long, and what those are told who come back.
#include <gtest/gtest.h>

#include "tests/unit/listener.h"

namespace coppice {
namespace {

TEST(Pieces, TheSmallerPieceStandsUntilItHearsOfTheLarger) {
  Listener a({"b", "c", "d", "e"});
  a.go_on_until(1, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
  a.go_on_until(60, {"b"});
  EXPECT_FALSE(a.failed("c"));
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(65, {"b"});
  EXPECT_TRUE(a.failed("c"));
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(70, {});  // one of its own piece dies: that changes nothing
  EXPECT_TRUE(a.failed("b"));
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(71, {"b"});
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(72, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
}

// Nor where what is left of its piece would, by names, be the one to go on after a minute.
TEST(Pieces, TheSmallerPieceStandsForAsLongWhereTheFirstOfItDies) {
  Listener b({"a", "c", "d", "e"}, "b");
  b.go_on_until(1, {"a", "c", "d", "e"});
  b.go_on_until(65, {"a"});
  EXPECT_TRUE(b.failed("c"));
  EXPECT_TRUE(b.cut_off());
  b.go_on_until(140, {});
  EXPECT_TRUE(b.failed("a"));
  EXPECT_TRUE(b.cut_off());
  b.go_on_until(141, {"c", "d", "e"});
  EXPECT_FALSE(b.cut_off());
}

// Who was never started is no part of a network in pieces, once that would have healed.
TEST(Pieces, TwoThatDieAtOnceStopNobodyHoweverManyNeverCame) {
  Listener a({"b", "c", "d", "e", "f", "g", "h", "i", "j"});
  a.go_on_until(12, {"b", "c", "d", "e"});
  EXPECT_TRUE(a.failed("j"));
  a.go_on_until(200, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
  a.go_on_until(265, {"b", "c"});
  EXPECT_TRUE(a.failed("d"));
  EXPECT_FALSE(a.cut_off());
}

// Another that is far away speaks rarely: it may have fallen silent with this one.
TEST(Pieces, NobodyIsSilentAloneBeforeAllOthersHaveSaidSomething) {
  Listener a;
  const Point2 far{1900, 1900};
  for (double now = 0; now < 1; now += period) {
    a.hear("b", now);
    a.hear("c", now, {}, Point2::Zero(), far);
    a.judge(now);
  }
  for (double now = 1; now < 4; now += period) a.judge(now);
  EXPECT_FALSE(a.failed("b"));
  a.hear("c", 4, {}, Point2::Zero(), far);
  for (double now = 4; now < 5; now += period) a.judge(now);
  EXPECT_TRUE(a.failed("b"));
  EXPECT_FALSE(a.failed("c"));
}

// A cut would have silenced both: how far one drove on is asked of the later one alone.
TEST(Pieces, WhoFellSilentBeforeAnotherIsNotInAPieceWithIt) {
  Listener a;
  double now = 0;
  for (; now < 1.8; now += period) {
    if (now < 1) a.hear("b", now, {}, {10, 0}, {40 + 10 * now, 110});
    a.hear("c", now, {}, {10, 0}, {40 + 10 * now, 50});
    a.judge(now);
  }
  for (; now < 130; now += period) a.judge(now);
  ASSERT_TRUE(a.failed("b") && a.failed("c"));
  double furthest_b = 0;
  double furthest_c = 0;
  for (const Disc& disc : a.failed_seen_from({80, 80}, now)) {
    double& furthest = disc.centre.y() > 80 ? furthest_b : furthest_c;
    furthest = std::max(furthest, disc.centre.x());
  }
  EXPECT_LT(furthest_b, 40 + 10 * 1 + 20 * 1.5);
  EXPECT_GT(furthest_c, 40 + 10 * 1.8 + 20 * 2.5);
}

TEST(Pieces, OfTwoThatMissEachOtherTheLaterNameStandsForAMinute) {
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
TEST(Pieces, AfterSomebodyCameBackNobodyIsTakenForDeadUntilItHasHeardTheNews) {
  Listener a;
  a.go_on_until(1, {"b", "c"});
  a.go_on_until(9, {"c"});
  EXPECT_TRUE(a.failed("b"));
  EXPECT_TRUE(a.peers_to_inform(a.now()).empty());
  a.go_on_until(10.5, {});
  a.go_on_until(13, {"b"});  // c would be failed by now
  EXPECT_FALSE(a.failed("c"));
  EXPECT_EQ(a.peers_to_inform(a.now()), std::vector<RobotName>{"b"});
  a.go_on_until(14, {"b"});
  EXPECT_TRUE(a.failed("c"));
  EXPECT_TRUE(a.peers_to_inform(a.now()).empty());
}

TEST(Pieces, WhoIsFirstHeardOfWhenTheOthersAreUnderWayIsToldOfTheDead) {
  Listener a;
  for (double now = 0; now < 12; now += period) {
    a.hear("c", now);
    a.judge(now);
  }
  EXPECT_TRUE(a.peers_to_inform(12).empty());
  a.hear("b", 12);
  EXPECT_EQ(a.peers_to_inform(12.1), std::vector<RobotName>{"b"});
}

}  // namespace
}  // namespace coppice
