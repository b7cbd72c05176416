// Tests of how long a robot stands and listens once it is in contact again (docs/safety.md, A10).
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "robot_agent/timing.h"
#include "tests/unit/robot_agent/agent_run.h"

namespace coppice {
namespace {

/// Robots that take so many seconds to brake.
Scenario slow_to_brake(double seconds) {
  Scenario scenario = two_robots();
  for (RobotTask& robot : scenario.robots) robot.max_acceleration = robot.max_speed / seconds;
  return scenario;
}

/// What "a" says from `begin` on. "b" stands, and is heard all the time. It does not hear "a" from `lost_at`
/// until `back_at`.
std::vector<RobotState> said_by_a(double braking, double begin, double lost_at, double back_at,
                                  double until) {
  PlannerService service(slow_to_brake(braking), {}, 0);
  RobotAgent agent("a");
  for (const Message& m : map_and_missions(service)) agent.on(arrival_of(m, begin));
  std::vector<Message> said;
  for (double now = begin; now < until; now = next_step(agent, now)) {
    RobotState b = state_of("b", now, {20, 20});
    b.max_acceleration = b.max_speed / braking;
    b.sequence = static_cast<std::uint32_t>(now / control_period);
    b.echoes = {{"a", now < back_at ? std::min(now, lost_at) : now, now}};
    agent.on(arrival_of(b, now));
    for (Message& message : messages(agent.step(now))) said.push_back(std::move(message));
  }
  return of<RobotState>(said);
}

// A state may be under way for 0.7 s. The robot counted on 0.3 s.
TEST(Listening, ARobotThatWasCutOffStandsUntilAllThatCouldNotKnowHaveBraked) {
  constexpr double lost_at = 2.5;
  constexpr double back_at = 12;
  const std::vector<RobotState> said = said_by_a(3, 0, lost_at, back_at, 30);
  const auto from = [&](double time) {
    return std::ranges::find_if(said, [&](const RobotState& s) { return s.promise.stamp >= time; });
  };
  ASSERT_GT(from(lost_at)->promise.velocity.norm(), 1);
  ASSERT_TRUE(from(back_at)->promise.stands());
  const auto sets_off = std::find_if(from(back_at), said.end(),
                                     [](const RobotState& s) { return !s.promise.next_velocity.isZero(0); });
  ASSERT_NE(sets_off, said.end());
  const double stood = sets_off->promise.decision_time - back_at;
  EXPECT_GE(stood, 3 + 2 * control_period + Timing::longest_transit);
  EXPECT_LT(stood, 3 + 2 * control_period + Timing::longest_transit + 2);
}

// It knew all others, and gave up after two minutes because it did not drive.
TEST(Listening, ARestartedRobotThatOnlyListensForLongDoesNotGiveUp) {
  const std::vector<RobotState> said = said_by_a(100, 20, 80, 90, 185);
  EXPECT_TRUE(std::ranges::none_of(said, [](const RobotState& s) { return s.phase == Phase::gave_up; }));
  EXPECT_TRUE(said.back().is_new) << "it still listens";
}

}  // namespace
}  // namespace coppice
