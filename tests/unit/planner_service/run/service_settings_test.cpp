// Tests of what the service's settings do to the map, the missions and the joint plan that it publishes.
#include <gtest/gtest.h>

#include "messages/validation.h"
#include "planner_service/run/planner_service.h"
#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

TEST(ServiceSettings, MissionsGoOutAtOnceIfTheTreesGrowTogether) {
  PlannerService service(two_robots(), {.forest = ForestStart::together}, 0);
  const auto first = service.step(0);
  EXPECT_EQ(of<Mission>(first).size(), 2u);
  EXPECT_TRUE(of<MapMessage>(first)[0].radii.empty());  // no broker grows ahead
}

TEST(ServiceSettings, TheParametersOfTheTreesGoToBrokersAndAgents) {
  const TreeParameters trees{.epsilon = 7, .disjointed_trees = 3, .kappa = 1, .restarts = Restarts::random};
  PlannerService service(two_robots(), {.trees = trees, .forest = ForestStart::together}, 0);
  const auto first = service.step(0);
  EXPECT_EQ(of<MapMessage>(first)[0].trees, trees);
  for (const Mission& mission : of<Mission>(first)) EXPECT_EQ(mission.trees, trees);
}

TEST(ServiceSettings, TheCoordinationGoesToTheAgents) {
  for (const Coordination c : {Coordination::reservations, Coordination::rvo}) {
    PlannerService service(two_robots(), {.forest = ForestStart::together, .coordination = c}, 0);
    const auto missions = of<Mission>(service.step(0));
    ASSERT_EQ(missions.size(), 2u);
    for (const Mission& mission : missions) EXPECT_EQ(mission.coordination, c);
  }
}

TEST(ServiceSettings, AGivenPlanGoesOutWithTheMissionsAndEndsWithTheRun) {
  const std::vector<Trajectory> plan{{{0, {20, 60}}, {4, {100, 60}}}, {{0, {20, 20}}, {1, {20, 40}}}};
  PlannerService service(two_robots(), {.forest = ForestStart::together, .plan = plan}, 0);
  const auto plans = of<JointPlanMessage>(service.step(0));
  ASSERT_EQ(plans.size(), 1u);
  EXPECT_EQ(plans[0].round.leader, service_as_leader);
  ASSERT_EQ(plans[0].members.size(), 2u);
  EXPECT_EQ(plans[0].members[1].robot, "b");
  EXPECT_EQ(path_of(plans[0].members[1].trajectory), path_of(plan[1]));
  EXPECT_EQ(problem_with(Message(plans[0])), std::nullopt);
  EXPECT_TRUE(of<JointPlanMessage>(service.step(0.1)).empty());
  service.interrupt();
  const auto last = service.step(0.2);
  EXPECT_EQ(of<Mission>(last).size(), 2u);  // cancelled
  EXPECT_TRUE(of<JointPlanMessage>(last).empty());
}

}  // namespace
}  // namespace coppice
