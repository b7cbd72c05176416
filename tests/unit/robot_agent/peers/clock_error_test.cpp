// Tests of how well a robot knows the clocks of its peers until it stands, if it decides something now.
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "messages/clock_offset.h"
#include "robot_agent/peers/fleet.h"
#include "tests/unit/robot_agent/states.h"

namespace coppice {
namespace {

Mission mission_of(const RobotName& robot, const Limits& limits) {
  return {.robot = robot,
          .start = {70, 70},
          .goal = {30, 30},
          .radius = 5,
          .max_speed = limits.max_speed,
          .max_acceleration = limits.max_acceleration,
          .clock = {},
          .max_angular_speed = limits.max_angular_speed,
          .max_angular_acceleration = limits.max_angular_acceleration};
}

// Clocks drift while the robot brakes.
TEST(ClockError, CoversTheWindowOfADecision) {
  constexpr double heard_at = 10.2;
  constexpr double now = 11;
  const std::vector<Limits> all{{20, 40}, {20, 2}, {20, 0.2}, {20, 0.25, 1, 1}};
  for (const Limits& own : all) {
    Fleet a("a");
    a.hear(mission_of("a", own), 0);
    a.hear(mission_of("b", {20, 40}), 0);
    RobotState state = state_of("b", 10, {100, 100});
    state.echoes = {{"a", 9.8, 9.9}};
    ASSERT_TRUE(a.hear(std::make_shared<const RobotState>(state), heard_at));
    ClockOffset clock;
    clock.hear(10, heard_at);
    clock.hear_echo(9.8, 9.9, heard_at);
    const double least = clock.error(now) + clock_drift * (braking_time(own) + 2 * control_period);

    AgeCount ages;
    std::vector<Neighbour> near;
    a.collect_neighbours({80, 80}, 100, 10, now, ages, near);
    ASSERT_EQ(near.size(), 1u);
    EXPECT_GE(near.front().clock_error, least) << braking_time(own);
    EXPECT_LE(near.front().clock_error, least + 0.001) << braking_time(own);
    EXPECT_GE(a.find("b", now)->clock_error, least) << braking_time(own);
    EXPECT_EQ(a.beside({80, 80}, 5, 10, now).front().clock_error, near.front().clock_error);
  }
}

}  // namespace
}  // namespace coppice
