#include "robot_agent/agreement/reservation_pair.h"

#include <gtest/gtest.h>

#include "robot_agent/agreement/reservations.h"

namespace coppice {
namespace {

ReservationMessage reserved_by(const RobotName& robot, std::uint32_t number,
                               std::vector<ReservationBasis> basis = {}) {
  return {.robot = robot,
          .number = number,
          .trajectory = {{0, {10, 10}}, {5, {50, 10}}},
          .basis = std::move(basis),
          .run = {}};
}
void hear(Reservations& others, const ReservationMessage& r) {
  others.hear(std::make_shared<const ReservationMessage>(r));
}

TEST(Reservations, ATrajectoryCountsFromItsFirstNumberThatWasHeard) {
  Reservations others;
  hear(others, reserved_by("b", 7));
  hear(others, reserved_by("b", 9));
  EXPECT_EQ(others.since("b"), 7u);
  ReservationMessage another = reserved_by("b", 12);
  another.trajectory.back().position.x() = 60;
  hear(others, another);
  EXPECT_EQ(others.since("b"), 12u);
  EXPECT_EQ(others.since("c"), 0u);
}

TEST(ReservationPair, TwoThatPlannedWithoutEachOtherAreNotRelated) {
  const ReservationMessage a = reserved_by("a", 3), b = reserved_by("b", 7, {{"a", 2, 0}});
  EXPECT_FALSE(are_related({a, 3}, {b, 7})) << "b planned around another trajectory of a";
}

TEST(ReservationPair, OneOfTwoThatPlannedAroundTheOtherRelatesThem) {
  const ReservationMessage a = reserved_by("a", 3), b = reserved_by("b", 7, {{"a", 3, 0.5}});
  EXPECT_TRUE(are_related({a, 3}, {b, 7}));
  EXPECT_EQ(offset_between({b, 7}, {a, 3}, 9), 0.5);
  EXPECT_EQ(offset_between({a, 3}, {b, 7}, 9), -0.5);
}

// Each names the number that the other one has just given up.
TEST(ReservationPair, TwoThatRenewTheirReservationsAtTheSameTimeKeepTheirOrder) {
  const ReservationMessage a = reserved_by("a", 5, {{"b", 7, -0.5}}),
                           b = reserved_by("b", 8, {{"a", 3, 0.5}});
  EXPECT_TRUE(are_related({a, 3}, {b, 7}));
  EXPECT_EQ(offset_between({b, 7}, {a, 3}, 9), 0.5);
}

}  // namespace
}  // namespace coppice
