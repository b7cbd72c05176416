#include "bus/simulated_bus.h"

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

TEST(SimulatedBus, DeliversAfterItsDelayToThoseWhoReadTheTopic) {
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

TEST(SimulatedBus, LateJoinersGetTheNewestOfEachKey) {
  SimulatedBus bus(0.5);
  auto& service = bus.attach(Role::service);
  service.publish(mission("r1", 1));
  service.publish(mission("r2", 1));
  service.publish(mission("r1", 2));
  auto& late = bus.attach(Role::agent);
  bus.set_time(1);
  const std::vector<Message> got = late.take();
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(std::get<Mission>(got[0]).number, 2u);
  EXPECT_EQ(std::get<Mission>(got[1]).robot, "r2");
}

TEST(SimulatedBus, StatesAreNotKeptForLateJoiners) {
  SimulatedBus bus(0.5);
  bus.attach(Role::agent).publish(RobotState{.robot = "r1", .radius = 1});
  auto& late = bus.attach(Role::agent);
  bus.set_time(1);
  EXPECT_TRUE(late.take().empty());
}

}  // namespace
}  // namespace coppice
