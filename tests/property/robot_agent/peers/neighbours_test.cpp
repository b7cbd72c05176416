// A robot considers each peer that it could touch within the window of a decision, however old the last state
// of the peer is, and however fast the two drive (docs/safety.md, L5).
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "coppice/planning/random.h"
#include "motion/body/driver.h"
#include "robot_agent/peers/fleet.h"
#include "simulation/fuzz_random.h"

namespace coppice {
namespace {

constexpr double oldest_state = 60;      // seconds
constexpr double longest_transit = 0.7;  // seconds

Point2 direction(Random& random) {
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  return {std::cos(angle), std::sin(angle)};
}

struct RobotKind {
  double radius = 0;
  Limits limits;
};

RobotKind any_kind(Random& random) {
  const double speed = log_uniform(0.1, 100, random);
  RobotKind body{random.uniform(0.1, 10), {speed, speed / log_uniform(0.05, 60, random)}};
  if (random.index(2) == 0) {
    body.limits.max_angular_speed = 1;
    body.limits.max_angular_acceleration = 1;
  }
  return body;
}

Mission mission_of(const RobotName& robot, const RobotKind& body) {
  return {.robot = robot,
          .radius = body.radius,
          .max_speed = body.limits.max_speed,
          .max_acceleration = body.limits.max_acceleration,
          .clock = {},
          .max_angular_speed = body.limits.max_angular_speed,
          .max_angular_acceleration = body.limits.max_angular_acceleration};
}

/// What "b" said at `stamp` by its clock. It may have bound itself to stand for longer.
RobotState any_state(const RobotKind& body, double stamp, Random& random) {
  RobotState state{.robot = "b",
                   .promise = {.stamp = stamp,
                               .decision_time = stamp + control_period,
                               .expiry = stamp + 2 * control_period},
                   .radius = body.radius,
                   .max_speed = body.limits.max_speed,
                   .max_acceleration = body.limits.max_acceleration,
                   .round = {},
                   .max_angular_speed = body.limits.max_angular_speed,
                   .max_angular_acceleration = body.limits.max_angular_acceleration};
  Promise& promise = state.promise;
  promise.position = {random.uniform(-1000, 1000), random.uniform(-1000, 1000)};
  if (random.index(3) == 0) {
    promise.expiry += random.uniform(0, 10);
  } else {
    promise.velocity = random.uniform(0, body.limits.max_speed) * direction(random);
    promise.next_velocity = within_limits(random.uniform(0, body.limits.max_speed) * direction(random),
                                          promise.velocity, body.limits, control_period);
  }
  return state;
}

// "a" sets off at full speed towards "b", which has driven at full speed towards "a" since its promise ended.
RC_GTEST_PROP(Neighbours, NoRobotIsLeftOutThatCouldBeTouchedWithinTheWindow, (std::uint64_t seed)) {
  Random random(seed);
  const RobotKind own = any_kind(random);
  const RobotKind other = any_kind(random);
  // Times are by the clock of "a".
  const double behind = random.uniform(-5, 5);  // the clock of "b"
  const double stamp = 100;
  const double heard_at = stamp + random.uniform(0, longest_transit);
  RobotState state = any_state(other, stamp - behind, random);
  const Promise promise = state.promise.shifted_by(behind);
  if (random.index(4) != 0) {
    const double said_at = stamp - random.uniform(0, 2 * longest_transit);
    state.echoes = {{"a", said_at, random.uniform(said_at, stamp) - behind}};
  }
  Fleet fleet("a");
  fleet.hear(mission_of("a", own), 0);
  fleet.hear(mission_of("b", other), 0);
  RC_ASSERT(fleet.hear(std::make_shared<const RobotState>(state), heard_at));

  const double begin = std::max(promise.expiry, heard_at) + random.uniform(0, oldest_state);
  const double closing = own.limits.max_speed + other.limits.max_speed;
  const double window = braking_time(own.limits) + 2 * control_period;
  const double touch_in = random.uniform(0, 2 * window + random.uniform(0, 20));
  const double touch_at = begin + touch_in;
  const Point2 towards_b = direction(random);
  const double apart = own.radius + other.radius + closing * touch_in;
  const Point2 a_begins =
      promise.position_at_expiry() - (apart + other.limits.max_speed * (begin - promise.expiry)) * towards_b;

  const double horizon = std::max(Driver::horizon, braking_time(own.limits)) + 3 * control_period;
  const double reach = own.radius + horizon * own.limits.max_speed;
  AgeCount ages;
  std::vector<Neighbour> near;
  for (double now = begin; now <= touch_at; now += control_period) {
    const Point2 position = a_begins + (now - begin) * own.limits.max_speed * towards_b;
    fleet.collect_neighbours(position, reach, horizon, now, ages, near);
    if (now + window >= touch_at) RC_ASSERT(near.size() == 1u);
  }
}

}  // namespace
}  // namespace coppice
