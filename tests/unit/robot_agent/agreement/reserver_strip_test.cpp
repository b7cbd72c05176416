// Tests of robots that give a reservation up and leave the strip of their way.
#include <memory>
#include <vector>

#include "tests/unit/robot_agent/two_reservers.h"

namespace coppice {
namespace {

class ReserverStripTest : public TwoReservers {
 protected:
  /// a gives up its reservation, on which b relies. Returns the state in which b then says that it has heard.
  RobotState after_a_drops(const Point2& place_of_b) {
    reserve_both();
    tell_state(b, a, 0.3);  // a says that it heeds b's reservation
    a.drop(1);
    tell(b, a);
    b.self.position = place_of_b;
    RobotState said = b.state(1.2);
    said.echoes = {{"a", 1.199, 1.2}};
    return said;
  }
  void a_hears(const RobotState& said) {
    a.fleet.hear(std::make_shared<const RobotState>(said), 1.201);
    a.reserver.hear(said);
    a.reserver.note_who_heard(a.fleet, 1.21);
  }
};

TEST_F(ReserverStripTest, ARobotLeavesItsStripWhenThoseWhoRelyOnItHaveHeardAndCouldHaveBraked) {
  reserve_both();
  tell_state(b, a, 0.3);  // a says that it heeds b's reservation
  a.drop(1);
  EXPECT_FALSE(a.reserver.may_leave_strip(a.self, a.fleet, 1));
  tell(b, a);
  b.self.position = {50, 100};
  tell_state(a, b, 1.2);
  EXPECT_FALSE(a.reserver.may_leave_strip(a.self, a.fleet, 1.2)) << "b may still brake";
  a.reserver.note_who_heard(a.fleet, 1.2);
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 1.2 + 0.2)) << "it stood when it said so";
}

// A robot that relies on an order leaves the other one out for its whole braking window, wherever that is.
// Two robots overlapped by 2.85 m after a partition of 1.5 s.
TEST_F(ReserverStripTest, ARobotStaysInItsStripForOneThatMayRelyOnItAlthoughTheirWaysAreFarFromEachOther) {
  b.path = {{100, 6}, {100, 60}};
  b.self.position = b.path.front();
  for (Robot* robot : {&a, &b}) robot->want(0);
  tell(b, a);
  tell(a, b);
  tell_state(a, b, 0);
  tell_state(b, a, 0);
  b.plan(0.1);  // its way is shorter
  tell(a, b);
  a.plan(0.2);
  tell(b, a);
  ASSERT_TRUE(a.reserver.holds() && b.reserver.holds());
  b.self.position = {100, 60};
  tell_state(a, b, 0.25);
  tell_state(b, a, 0.3);  // a says that it heeds b's reservation
  a.drop(1);
  EXPECT_FALSE(a.reserver.may_leave_strip(a.self, a.fleet, 1));
  EXPECT_FALSE(a.reserver.may_leave_strip(a.self, a.fleet, 1 + 1));
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 1 + 2.7))
      << "b heard no recent state, and has braked";
}

TEST_F(ReserverStripTest, ARobotThatBrakesSlowlyIsWaitedForUntilItStands) {
  RobotState drives = after_a_drops({31, 100});
  drives.promise.velocity = drives.promise.next_velocity = {20, 0};
  a_hears(drives);
  EXPECT_FALSE(a.reserver.may_leave_strip(a.self, a.fleet, 1.2 + 0.5));
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 1.2 + 0.62));
}

// A robot that waited at a gate had bound itself for 45 s, and others stayed in their strips for all that
// time.
TEST_F(ReserverStripTest, ARobotThatHasBoundItselfToStandIsNotWaitedFor) {
  RobotState stands = after_a_drops({50, 100});
  stands.promise.expiry = 1.2 + 45;
  a_hears(stands);
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 1.2 + 0.2));
}

TEST_F(ReserverStripTest, ARobotLeavesItsStripAtOnceIfThoseThatHaveHeardStandTooFarAwayToMeetIt) {
  reserve_both();
  tell_state(b, a, 0.3);
  a.drop(1);
  tell(b, a);
  tell_state(a, b, 1.2);  // 113 m away
  a.reserver.note_who_heard(a.fleet, 1.2);
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 1.2));
}

TEST_F(ReserverStripTest, ARobotThatHearsNothingLeavesItsStripWhenNoRecentStateNamesItsReservation) {
  reserve_both();
  b.self.position = {50, 100};
  tell_state(a, b, 0.25);
  tell_state(b, a, 0.3);
  a.drop(1);
  EXPECT_FALSE(a.reserver.may_leave_strip(a.self, a.fleet, 1 + 2.5));
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 1 + 2.7));
}

// b relied on the strip on its way, until it renewed its reservation. Nothing of the new one is confirmed
// yet.
TEST_F(ReserverStripTest, ARobotThatHasRenewedItsReservationMayStillBrakeWhereItReliedOnTheStrip) {
  reserve_both();
  tell_state(b, a, 0.3);  // a says that it heeds b's reservation
  ReservationMessage renewed = b.last();
  renewed.number += 1;
  a.others.hear(std::make_shared<const ReservationMessage>(renewed));
  b.self.position = {50, 100};
  tell_state(a, b, 0.9);
  a.drop(1);
  EXPECT_FALSE(a.reserver.may_leave_strip(a.self, a.fleet, 1 + 2.5));
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 1 + 2.7));
}

// It stood in between, so it has come to rest.
TEST_F(ReserverStripTest, ARobotThatHasReservedAnewIsNotWaitedForUntilItIsToldSo) {
  reserve_both();
  tell_state(b, a, 0.3);
  ReservationMessage another = b.last();
  another.first_number = another.number += 1;
  another.trajectory.back().position += Point2(5, 0);
  a.others.hear(std::make_shared<const ReservationMessage>(another));
  a.drop(1);
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 1));
}

// b counts on what the process of a before this one has told it, as long as b's reservation stays the same.
TEST_F(ReserverStripTest, AfterARestartAllWithReservationsMayRelyOnTheStrip) {
  reserve_both();
  b.self.position = {50, 100};
  tell_state(a, b, 0.3);
  a.reserver.begin_anew(a.fleet, 0.3, 0.3);
  a.want(3.5);
  a.plan(3.6);
  ASSERT_TRUE(a.reserver.holds());
  a.drop(4);
  EXPECT_FALSE(a.reserver.may_leave_strip(a.self, a.fleet, 4 + 2.5));
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 4 + 2.7));
}

TEST_F(ReserverStripTest, ARobotInWhoseStatesNobodyIsHeededMayLeaveItsStripAtOnce) {
  reserve_both();
  a.drop(1);
  EXPECT_TRUE(a.reserver.may_leave_strip(a.self, a.fleet, 1));
}

}  // namespace
}  // namespace coppice
