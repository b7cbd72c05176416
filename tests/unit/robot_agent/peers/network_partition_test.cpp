// Tests of network partitions: which robots drive on, how long others stand, and what returning robots are
// told.
#include <gtest/gtest.h>

#include "tests/unit/robot_agent/listener.h"

namespace coppice {
namespace {

TEST(NetworkPartition, TheSmallerPartStandsUntilItHearsTheLarger) {
  Listener a({"b", "c", "d", "e"});
  a.go_on_until(1, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
  a.go_on_until(60, {"b"});
  EXPECT_FALSE(a.failed("c"));
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(65, {"b"});
  EXPECT_TRUE(a.failed("c"));
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(70, {});  // a robot of the same part fails; that changes nothing
  EXPECT_TRUE(a.failed("b"));
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(71, {"b"});
  EXPECT_TRUE(a.cut_off());
  a.go_on_until(72, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
}

// The order of names does not let the rest of the part drive on after a minute either.
TEST(NetworkPartition, TheSmallerPartStandsAsLongIfItsFirstRobotFails) {
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

// A robot that was never started is not part of a partition once the partition would have healed.
TEST(NetworkPartition, TwoFailuresStopNobodyHoweverManyRobotsNeverCame) {
  Listener a({"b", "c", "d", "e", "f", "g", "h", "i", "j"});
  a.go_on_until(12, {"b", "c", "d", "e"});
  EXPECT_TRUE(a.failed("j"));
  a.go_on_until(200, {"b", "c", "d", "e"});
  EXPECT_FALSE(a.cut_off());
  a.go_on_until(265, {"b", "c"});
  EXPECT_TRUE(a.failed("d"));
  EXPECT_FALSE(a.cut_off());
}

// Another robot that is far away sends rarely. It may have fallen silent together with this one.
TEST(NetworkPartition, NoPeerIsSinglySilentBeforeAllOthersWereHeard) {
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

// A partition would have silenced both at once. Only for the later one must the zone include driving on.
TEST(NetworkPartition, APeerThatFellSilentEarlierIsNotInAPartWithALaterOne) {
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

TEST(NetworkPartition, OfTwoRobotsThatMissEachOtherTheLaterNameStandsForAMinute) {
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

// The robot was not told what the others learnt meanwhile, and it did not tell them.
TEST(NetworkPartition, NoPeerIsDeclaredFailedBeforeAReturningRobotIsInformed) {
  Listener a;
  a.go_on_until(1, {"b", "c"});
  a.go_on_until(9, {"c"});
  EXPECT_TRUE(a.failed("b"));
  EXPECT_TRUE(a.peers_to_inform(a.now()).empty());
  a.go_on_until(10.5, {});
  a.go_on_until(13, {"b"});  // otherwise c would be declared failed by now
  EXPECT_FALSE(a.failed("c"));
  EXPECT_EQ(a.peers_to_inform(a.now()), std::vector<RobotName>{"b"});
  a.go_on_until(14, {"b"});
  EXPECT_TRUE(a.failed("c"));
  EXPECT_TRUE(a.peers_to_inform(a.now()).empty());
}

TEST(NetworkPartition, APeerThatIsFirstHeardLateIsToldOfFailedRobots) {
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
