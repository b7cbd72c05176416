// Tests of an agent in a fleet without reservations, message by message.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/robot_agent/agent_run.h"

namespace coppice {
namespace {

/// What agent a says in its first two seconds. Robot b stands at its start, and looks for its path.
std::vector<Message> said_while_b_plans(Coordination coordination) {
  PlannerService service(two_robots(), {.coordination = coordination}, 0);
  AgentRun a;
  for (const Message& message : map_and_missions(service)) a.hear(message, 0);
  for (double now = 0.05; now < 2; now = next_step(a.agent, now)) {
    RobotState b = a.standing_b(now);
    b.phase = Phase::planning;
    a.hear(b, now);
    for (Outgoing& one : a.agent.step(now)) a.said.push_back(std::move(one.message));
  }
  return a.said;
}

TEST(AgentWithoutReservations, ItSetsOffAlongItsPathWhileAnotherPlans) {
  const auto said = said_while_b_plans(Coordination::rvo);
  const Promise last = of<RobotState>(said).back().promise;
  // Towards the door, which lies to the right and above.
  EXPECT_GT(last.position.x(), 25);
  EXPECT_LT(last.position.y(), 55);
  EXPECT_GT(last.velocity.norm(), 15);
}

TEST(AgentWithoutReservations, ItWishesAndReservesNothing) {
  EXPECT_TRUE(of<ReservationMessage>(said_while_b_plans(Coordination::rvo)).empty());
  EXPECT_FALSE(of<ReservationMessage>(said_while_b_plans(Coordination::reservations)).empty());
}

TEST(AgentWithoutReservations, OneWithReservationsWaitsForTheTurnOfTheOther) {
  const auto said = said_while_b_plans(Coordination::reservations);
  EXPECT_EQ(of<RobotState>(said).back().promise.position, Point2(20, 60));
}

}  // namespace
}  // namespace coppice
