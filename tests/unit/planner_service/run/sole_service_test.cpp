// Tests that one of several services on a domain goes on.
#include "planner_service/run/sole_service.h"

#include <gtest/gtest.h>

#include "planner_service/run/roll_call.h"
#include "tests/unit/planner_service/roles.h"

namespace coppice {
namespace {

ServiceStatus service(std::uint64_t id, WallTime since, WallTime run = 0) {
  return {
      .service = id, .host = "h", .process = static_cast<std::uint32_t>(id), .since = since, .run = {run}};
}

/// Whether the second service gives way and the first does not, when each hears of the other.
bool gives_way(const ServiceStatus& second, const ServiceStatus& first) {
  SoleService a(first, first.since);
  SoleService b(second, second.since);
  a.on(arrival_of(second, 100));
  b.on(arrival_of(first, 100));
  EXPECT_NE(a.superior().has_value(), b.superior().has_value()) << "exactly one service goes on";
  EXPECT_EQ(a.take_inferiors().size(), a.superior() ? 0u : 1u);
  return b.superior().has_value();
}

TEST(SoleService, TheSecondServiceGivesWay) {
  EXPECT_TRUE(gives_way(service(1, 20), service(2, 10)));
  EXPECT_TRUE(gives_way(service(1, 20), service(2, 10, 12)));
  EXPECT_TRUE(gives_way(service(1, 5), service(2, 10, 12)))
      << "the clock of the second service may be behind";
  EXPECT_TRUE(gives_way(service(2, 10), service(1, 10))) << "both were started at once";
}

// Agents follow the newer run. A service that was paused meanwhile has lost its fleet.
TEST(SoleService, TheServiceWithTheNewerRunGoesOn) {
  EXPECT_TRUE(gives_way(service(1, 10, 12), service(2, 50, 52)));
}

TEST(SoleService, AServiceThatResumesItsRunGoesBeforeOneWithoutARun) {
  EXPECT_TRUE(gives_way(service(1, 50), service(2, 60, 12)));
}

TEST(SoleService, AServiceListensFirstAndLongerIfAgentsDrive) {
  SoleService sole(service(1, 10), 10);
  EXPECT_FALSE(sole.may_begin(10.9));
  EXPECT_TRUE(sole.may_begin(11.1));
  sole.on(arrival_of(AgentStatus{.robot = "a", .phase = Phase::stopped, .run = {3}}, 10.5));
  EXPECT_TRUE(sole.may_begin(11.1)) << "that run is over";
  sole.on(arrival_of(AgentStatus{.robot = "a", .phase = Phase::driving, .run = {3}}, 10.5));
  EXPECT_FALSE(sole.may_begin(14.9));
  EXPECT_TRUE(sole.may_begin(15.1)) << "no service claims these agents";
}

TEST(SoleService, AServiceThatResumesItsRunKnowsItsAgents) {
  SoleService sole(service(1, 10), 10);
  sole.begin({3});
  sole.on(arrival_of(AgentStatus{.robot = "a", .phase = Phase::driving, .run = {3}}, 10.5));
  EXPECT_TRUE(sole.may_begin(11.1));
  EXPECT_EQ(of<ServiceStatus>(sole.step(11)).at(0).run, RunId{3});
}

TEST(SoleService, AServiceIsNamedByProcessHostAndRun) {
  EXPECT_EQ(description_of(service(7, 10, 12), 20), "process 7 on host h (its run began 8 s ago)");
  EXPECT_EQ(description_of(service(7, 10), 20), "process 7 on host h (it has begun no run yet)");
}

TEST(RollCall, AgentsWithoutMissionsAndMissingAgentsAreNamed) {
  RollCall roll({"r1", "r2"}, 0);
  roll.on(arrival_of(AgentStatus{.robot = "r1"}, 1));
  EXPECT_TRUE(roll.step(1).empty());
  roll.on(arrival_of(AgentStatus{.robot = "r9"}, 2));
  EXPECT_EQ(roll.step(2), std::vector<std::string>{"no mission for r9: the run has r1, r2"});
  EXPECT_TRUE(roll.step(3).empty());
  EXPECT_EQ(roll.step(7), std::vector<std::string>{"no agent has come for r2 (robot_agent --name r2)"});
  EXPECT_TRUE(roll.step(60).empty());
}

TEST(RollCall, ACompleteFleetIsNotMentioned) {
  RollCall roll({"r1"}, 0);
  roll.on(arrival_of(AgentStatus{.robot = "r1"}, 1));
  EXPECT_TRUE(roll.step(10).empty());
}

}  // namespace
}  // namespace coppice
