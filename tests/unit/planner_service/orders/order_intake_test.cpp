// Tests of which orders are of a fleet before this one.
#include "planner_service/orders/order_intake.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

OrderMessage order(const char* id) {
  return {.id = id, .visits = {{{1, 2}}}};
}

TEST(OrderIntake, AnOrderFromBeforeTheFleetIsRefusedUnlessItIsRepeated) {
  OrderIntake intake(100);
  EXPECT_FALSE(intake.takes(order("old"), 101, 99));
  EXPECT_FALSE(intake.takes(order("repeated"), 101, 99));
  EXPECT_TRUE(intake.takes(order("new"), 101, 100.5));
  EXPECT_TRUE(intake.takes(order("repeated"), 102, 101.9)) << "its sender waits for an answer";
  EXPECT_TRUE(intake.take_outdated(103.9).empty());
  const auto outdated = intake.take_outdated(104.1);
  ASSERT_EQ(outdated.size(), 1u);
  EXPECT_EQ(outdated[0].id, "old");
  EXPECT_TRUE(intake.take_outdated(200).empty());
}

TEST(OrderIntake, AnOrderOfWhichNobodyKnowsWhenItWasSentIsNew) {
  EXPECT_TRUE(OrderIntake(100).takes(order("1"), 101, 0));
}

// The run began at 50, and its service was killed: an order that it had not heard of is still for it.
TEST(OrderIntake, AServiceThatGoesOnWithARunTakesItsOrders) {
  OrderIntake intake(100);
  intake.fleet_began(50);
  EXPECT_TRUE(intake.takes(order("1"), 101, 99));
  EXPECT_FALSE(intake.takes(order("2"), 101, 49));
}

TEST(OrderIntake, ARunThatSeemsToBeginLaterMakesNoOrderOld) {
  OrderIntake intake(100);
  intake.fleet_began(5000);
  EXPECT_TRUE(intake.takes(order("1"), 101, 100.5));
}

}  // namespace
}  // namespace coppice
