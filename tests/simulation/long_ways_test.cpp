// Robots whose ways are tens of thousands of radii long: one search does not find their trajectories.
#include <gtest/gtest.h>

#include "simulation/fleet_simulation.h"
#include "simulation/invariants.h"
#include "tests/winding_map.h"

namespace coppice {
namespace {

constexpr int side = 400;
constexpr int corridors = side / 8;

/// A way of 20 km for the first robot, which is 49,000 radii.
Scenario long_way(int robots) {
  Scenario scenario{.map_name = "winding", .map = test::winding_map(side), .robots = {}};
  for (int k = 0; k < robots; ++k) {
    RobotTask robot = robot_on(scenario.map);
    robot.name = "r" + std::to_string(k + 1);
    robot.radius = 0.4;
    robot.start = test::in_corridor(0, 10 + 5 * k);
    robot.goal = test::in_corridor(corridors - 1, side - 10 - 5 * k);
    if (k % 2 == 1) std::swap(robot.start, robot.goal);
    scenario.robots.push_back(robot);
  }
  return scenario;
}

struct Driven {
  proto::Report report;
  std::vector<std::string> broken;
  std::size_t reservations = 0;
  std::size_t joint_plans = 0;
};

Driven driven(const Scenario& scenario, double seconds) {
  FleetSimulation simulation(scenario, {.timeout = seconds});
  Driven result;
  simulation.set_listener([&](const Message& message, double) {
    if (const auto* r = std::get_if<ReservationMessage>(&message))
      result.reservations += !r->trajectory.empty();
    result.joint_plans += std::holds_alternative<JointPlanMessage>(message);
  });
  simulation.run([](const PlannerService&, double) { return true; });
  result.report = simulation.service().report();
  result.broken = broken_invariants(scenario, simulation);
  return result;
}

TEST(LongWays, ARobotThatIsAloneDrivesAtOnceAndReservesAnewOnTheWay) {
  const Driven result = driven(long_way(1), 1'300);
  ASSERT_EQ(result.report.outcome(), "arrived");
  EXPECT_TRUE(result.broken.empty());
  EXPECT_EQ(result.joint_plans, 0u);
  EXPECT_GT(result.reservations, 1u);
  EXPECT_LT(result.report.robots(0).waits().reservation(), 10);
}

TEST(LongWays, RobotsThatMeetPassEachOther) {
  const Driven result = driven(long_way(2), 1'500);
  EXPECT_EQ(result.report.outcome(), "arrived");
  EXPECT_TRUE(result.broken.empty());
}

}  // namespace
}  // namespace coppice
