// Tests of how two reservations belong together.
#include "messages/reservation_relation.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

ReservationMessage reserved_by(const RobotName& robot, std::uint32_t number, std::uint32_t first_number,
                               std::vector<ReservationBasis> basis = {}) {
  return {.robot = robot,
          .number = number,
          .first_number = first_number,
          .trajectory = {{0, {10, 10}}, {5, {50, 10}}},
          .basis = std::move(basis),
          .run = {}};
}

TEST(ReservationRelation, TwoThatPlannedWithoutEachOtherAreNotRelated) {
  const ReservationMessage a = reserved_by("a", 3, 3), b = reserved_by("b", 7, 7, {{"a", 2, 0}});
  EXPECT_FALSE(are_related(a, b)) << "b planned around another trajectory of a";
}

TEST(ReservationRelation, OneOfTwoThatPlannedAroundTheOtherRelatesThem) {
  const ReservationMessage a = reserved_by("a", 3, 3), b = reserved_by("b", 7, 7, {{"a", 3, 0.5}});
  EXPECT_TRUE(are_related(a, b));
  EXPECT_EQ(offset_between(b, a, 9), 0.5);
  EXPECT_EQ(offset_between(a, b, 9), -0.5);
}

// Each names the number that the other one has just given up.
TEST(ReservationRelation, TwoThatRenewTheirReservationsAtTheSameTimeKeepTheirOrder) {
  const ReservationMessage a = reserved_by("a", 5, 3, {{"b", 7, -0.5}}),
                           b = reserved_by("b", 8, 7, {{"a", 3, 0.5}});
  EXPECT_TRUE(are_related(a, b));
  EXPECT_EQ(offset_between(b, a, 9), 0.5);
}

}  // namespace
}  // namespace coppice
