#include "simulation/simulated_bus.h"

#include <map>

#include <gtest/gtest.h>

namespace coppice {
namespace {

Mission mission(const char* robot, std::uint32_t number) {
  return {.robot = robot,
          .number = number,
          .map_id = "m",
          .radius = 1,
          .max_speed = 1,
          .max_acceleration = 1,
          .goal_tolerance = 1};
}

TEST(SimulatedBus, AMessageReachesTheReadersOfItsTopicAfterTheDelay) {
  SimulatedBus bus(0.5);
  auto& service = bus.attach(Role::service);
  auto& agent = bus.attach(Role::agent);
  service.publish(mission("r1", 1));
  EXPECT_TRUE(agent.take().empty());
  EXPECT_EQ(agent.next_delivery(), 0.5);
  bus.set_time(0.5);
  ASSERT_EQ(agent.take().size(), 1u);
  EXPECT_TRUE(agent.take().empty());
  EXPECT_TRUE(service.take().empty());  // services read no missions
}

TEST(SimulatedBus, ALateJoinerGetsTheNewestMessageOfEachKey) {
  SimulatedBus bus(0.5);
  auto& service = bus.attach(Role::service);
  service.publish(mission("r1", 1));
  service.publish(mission("r2", 1));
  service.publish(mission("r1", 2));
  auto& late = bus.attach(Role::agent);
  bus.set_time(1);
  const std::vector<Arrival> got = late.take();
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(std::get<Mission>(*got[0].message).number, 2u);
  EXPECT_EQ(std::get<Mission>(*got[1].message).robot, "r2");
}

TEST(SimulatedBus, TheBusKeepsOnlyTopicsOfTheRoleThatMayStillJoin) {
  SimulatedBus bus(0.5);
  auto& service = bus.attach(Role::service);
  auto& agent = bus.attach(Role::agent);
  bus.keep_for(Role::agent);
  service.publish(mission("r1", 1));
  agent.publish(AgentStatus{.robot = "r1", .reason = {}});  // services and monitors read it
  auto& late = bus.attach(Role::agent);
  auto& observer = bus.attach(Role::observer);
  bus.set_time(1);
  EXPECT_EQ(service.take().size(), 1u);
  EXPECT_EQ(late.take().size(), 1u);
  const std::vector<Arrival> seen = observer.take();
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<Mission>(*seen[0].message));
}

TEST(SimulatedBus, StatesAreNotKeptForLateJoiners) {
  SimulatedBus bus(0.5);
  bus.attach(Role::agent).publish(RobotState{.robot = "r1", .radius = 1});
  auto& late = bus.attach(Role::agent);
  bus.set_time(1);
  EXPECT_TRUE(late.take().empty());
}

RobotState state(double stamp) {
  return {.robot = "r1",
          .promise = {.stamp = stamp,
                      .decision_time = stamp + 0.05,
                      .next_velocity = {0, 0},
                      .expiry = stamp + 0.1},
          .radius = 1,
          .max_speed = 1,
          .max_acceleration = 1};
}

/// The stamps of 1000 states, one each 0.05 s, in the order of arrival.
std::vector<double> stamps_through(const BusFaults& faults) {
  SimulatedBus bus(0.001, faults, Random(3));
  auto& sender = bus.attach(Role::agent, "r1", 0);
  auto& receiver = bus.attach(Role::agent, "r2", 1);
  std::vector<double> stamps;
  for (int k = 0; k < 1100; ++k) {
    bus.set_time(0.05 * k);
    if (k < 1000) sender.publish(state(0.05 * k));
    for (const Arrival& a : receiver.take()) stamps.push_back(std::get<RobotState>(*a.message).promise.stamp);
  }
  return stamps;
}

TEST(SimulatedBus, TheBusLosesTheGivenShare) {
  const auto stamps = stamps_through({.loss = 0.3});
  EXPECT_NEAR(static_cast<double>(stamps.size()), 700, 60);
  EXPECT_TRUE(std::ranges::is_sorted(stamps));
}

TEST(SimulatedBus, DelaysStayWithinTheJitterAndInOrderByDefault) {
  const auto in_order = stamps_through({.delay = 0.2, .jitter = 0.1});
  EXPECT_EQ(in_order.size(), 1000u);
  EXPECT_TRUE(std::ranges::is_sorted(in_order));
  const auto reordered = stamps_through({.delay = 0.2, .jitter = 0.1, .reorder = true});
  EXPECT_EQ(reordered.size(), 1000u);
  EXPECT_FALSE(std::ranges::is_sorted(reordered));
}

TEST(SimulatedBus, DuplicatesArriveTwice) {
  EXPECT_NEAR(static_cast<double>(stamps_through({.duplicate = 0.5}).size()), 1500, 60);
}

TEST(SimulatedBus, NothingCrossesAPartition) {
  for (const double stamp : stamps_through({.partitions = {{10, 20}}}))
    EXPECT_TRUE(stamp < 10 || stamp >= 20);
}

TEST(SimulatedBus, ACutLinkSeparatesTwoRobotsOnly) {
  SimulatedBus bus(0.001, {.cut_links = {{"a", "b", 10, 20}}});
  std::map<RobotName, SimulatedBus::Port*> ports;
  for (const char* robot : {"a", "b", "c"}) ports[robot] = &bus.attach(Role::agent, robot);
  const auto reaches = [&](const RobotName& from, const RobotName& to, double time) {
    bus.set_time(time);
    for (const auto& [robot, port] : ports) port->take();
    ports[from]->publish(RobotState{.robot = from, .radius = 1, .max_speed = 1, .max_acceleration = 1});
    bus.set_time(time + 0.01);
    return !ports[to]->take().empty();
  };
  EXPECT_TRUE(reaches("a", "b", 9));
  EXPECT_FALSE(reaches("a", "b", 10));
  EXPECT_FALSE(reaches("b", "a", 15));
  EXPECT_FALSE(ports["c"]->take().empty());
  EXPECT_TRUE(reaches("a", "c", 16));
  EXPECT_TRUE(reaches("c", "b", 17));
  EXPECT_TRUE(reaches("b", "a", 20));
}

TEST(SimulatedBus, ReliableSamplesArriveOnceAndInOrderDespiteLoss) {
  SimulatedBus bus(0.001, {.loss = 0.5, .delay = 0.1, .jitter = 0.1, .duplicate = 0.5, .reorder = true},
                   Random(1));
  auto& service = bus.attach(Role::service);
  auto& agent = bus.attach(Role::agent);
  for (std::uint32_t k = 1; k <= 200; ++k) service.publish(mission("r1", k));
  bus.set_time(1000);
  std::uint32_t next = 1;
  for (const Arrival& a : agent.take()) EXPECT_EQ(std::get<Mission>(*a.message).number, next++);
  EXPECT_EQ(next, 201u);
}

TEST(SimulatedBus, NothingReachesAClosedPort) {
  SimulatedBus bus(0.5);
  auto& service = bus.attach(Role::service);
  auto& agent = bus.attach(Role::agent);
  service.publish(mission("r1", 1));
  agent.close();
  service.publish(mission("r1", 2));
  bus.set_time(5);
  EXPECT_TRUE(agent.take().empty());
}

}  // namespace
}  // namespace coppice
