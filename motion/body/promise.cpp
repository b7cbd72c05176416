#include "motion/body/promise.h"

#include <algorithm>
#include <cmath>

namespace coppice {

Point2 rest_after(const Promise& promise, const Limits& limits, double period) {
  const double speed = promise.next_velocity.norm();
  if (speed == 0) return promise.position_at_expiry();
  if (promise.next_angular_velocity != 0) {
    Point2 rest = promise.position_at_expiry();
    Twist twist{promise.next_velocity, promise.next_angular_velocity};
    while (!twist.velocity.isZero(0)) rest += period * (twist = braked(twist, limits, period)).velocity;
    return rest;
  }
  return promise.position_at_expiry() +
         promise.next_velocity * (braking_distance(speed, limits, period) / speed);
}

std::vector<Point2> rests_after(const Promise& promise, const Limits& limits, double period, int unheard,
                                double step) {
  std::vector<Point2> rests{rest_after(promise, limits, period)};
  double speed = promise.next_velocity.norm();
  if (speed == 0) return rests;
  const Point2 heading = promise.next_velocity / speed;
  double driven = 0;
  for (int k = 0; k < unheard; ++k) {
    speed = std::min(limits.max_speed, speed + limits.max_acceleration * period);
    driven += speed * period;
  }
  const Point2 furthest =
      promise.position_at_expiry() + heading * (driven + braking_distance(speed, limits, period));
  const double length = (furthest - rests.front()).norm();
  const int steps = static_cast<int>(std::ceil(length / step));
  for (int k = 1; k <= steps; ++k) rests.emplace_back(rests.front() + heading * (length * k / steps));
  return rests;
}

}  // namespace coppice
