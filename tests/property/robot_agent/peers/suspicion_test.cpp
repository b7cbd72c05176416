// A peer that is cut off drives until it notices, and brakes. It stays in the disc that others keep clear
// (docs/safety.md, L10).
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "coppice/planning/random.h"
#include "motion/body/differential_drive.h"
#include "motion/body/promise.h"
#include "robot_agent/timing.h"
#include "simulation/fuzz_random.h"

namespace coppice {
namespace {

constexpr double rounding = 1e-9;  // share of the disc's radius

Limits any_limits(Random& random) {
  const double speed = log_uniform(0.1, 100, random);
  Limits limits{speed, speed / log_uniform(0.05, 60, random)};
  if (random.index(2) == 0) {
    limits.max_angular_speed = log_uniform(0.05, fastest_turning, random);
    limits.max_angular_acceleration = limits.max_angular_speed / log_uniform(0.05, 10, random);
  }
  return limits;
}

struct Body {
  Point2 position = Point2::Zero();
  double yaw = 0;
  Twist twist{};

  void advance(const Twist& next) {
    position += control_period * twist.velocity;
    yaw += control_period * twist.angular_velocity;
    twist = next;
  }
};

/// What the robot drives for: a velocity, and a rate of turning.
struct Whim {
  Point2 velocity = Point2::Zero();
  double turning = 0;
};

Whim any_whim(const Limits& limits, Random& random) {
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  const double speed = random.index(2) == 0 ? limits.max_speed : random.uniform(0, limits.max_speed);
  return {speed * Point2(std::cos(angle), std::sin(angle)),
          random.index(2) == 0 ? 0 : random.uniform(-1, 1) * limits.max_angular_speed};
}

Twist next_twist(const Whim& whim, const Body& body, const Limits& limits) {
  const Twist& twist = body.twist;
  if (!is_differential(limits))
    return {within_limits(whim.velocity, twist.velocity, limits, control_period), 0};
  const double heading = body.yaw + control_period * twist.angular_velocity;
  const double most = limits.max_angular_acceleration * control_period;
  const double turning =
      std::clamp(whim.turning, twist.angular_velocity - most, twist.angular_velocity + most);
  return feasible_twist(whim.velocity.norm(), turning, twist, heading, limits, control_period);
}

/// The robot has driven, or sets off from standstill. Then nobody hears it any more.
void assert_stays_in_its_disc(Random& random) {
  const Limits limits = any_limits(random);
  const double fickle = log_uniform(0.001, 1, random);
  Whim whim = any_whim(limits, random);
  Body body{.yaw = random.uniform(-3, 3)};
  const auto drive = [&] {
    if (random.uniform() < fickle) whim = any_whim(limits, random);
    body.advance(next_twist(whim, body, limits));
  };
  const bool sets_off = random.index(2) == 0;
  for (std::size_t k = sets_off ? 0 : random.index(200); k > 0; --k) drive();

  Promise promise{.position = body.position,
                  .velocity = body.twist.velocity,
                  .decision_time = control_period,
                  .expiry = 2 * control_period,
                  .yaw = body.yaw,
                  .angular_velocity = body.twist.angular_velocity};
  drive();
  promise.next_velocity = body.twist.velocity;
  promise.next_angular_velocity = body.twist.angular_velocity;
  const Point2 rests = rest_after(promise, limits, control_period);

  const double seconds = Timing::longest_unheard + Timing::unheard_before;
  const double disc = seconds * limits.max_speed + braking_distance(limits.max_speed, limits, control_period);
  const auto most_periods = static_cast<std::size_t>(std::lround(seconds / control_period));
  if (random.index(2) == 0) whim = any_whim(limits, random);
  // One period is over, and another one passes before the robot slows down.
  const bool notices_late = random.index(2) == 0;
  for (std::size_t k = notices_late ? most_periods - 2 : random.index(most_periods - 1); k > 0; --k) drive();
  body.advance(braked(body.twist, limits, control_period));
  RC_ASSERT((body.position - rests).norm() <= disc * (1 + rounding));
  while (body.twist.velocity.norm() > 0) {
    body.advance(braked(body.twist, limits, control_period));
    RC_ASSERT((body.position - rests).norm() <= disc * (1 + rounding));
  }
}

RC_GTEST_PROP(Suspicion, ARobotThatIsCutOffStaysInItsDiscUntilItStands, (std::uint64_t seed)) {
  Random random(seed);
  for (int k = 0; k < 100; ++k) assert_stays_in_its_disc(random);
}

}  // namespace
}  // namespace coppice
