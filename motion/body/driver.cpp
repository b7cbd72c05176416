#include "motion/body/driver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "coppice/motion/reciprocal_velocity.h"
#include "motion/body/differential_drive.h"
#include "planning/geometry/way_out.h"

namespace coppice {

namespace {

constexpr double obstacle_horizon =
    0.25;                       // seconds; the promise keeps clear of obstacles until standstill in any case
constexpr int directions = 16;  // directions of the velocities that are tried around the current one
// Shares of the largest change of velocity in a period that are tried.
constexpr std::array shares{1.0, 0.6, 0.3};
// Shares of the wanted speed, tried in order.
constexpr std::array speeds{1.0, 0.9, 0.8, 0.7, 0.6, 0.5};
constexpr std::array low_speeds{0.35, 0.2, 0.1, 0.03};
constexpr double straight = 1e-6;  // radians a second
constexpr double faces = 0.05;     // radians by which a robot that drives out heads elsewhere, at most

}  // namespace

Driver::Driver(const Promise& promise, double radius, const Limits& limits, double period)
    : position_(promise.position),
      time_(promise.stamp),
      radius_(radius),
      limits_(limits),
      period_(period),
      yaw_(promise.yaw),
      twist_{promise.velocity, promise.angular_velocity},
      next_{promise.next_velocity, promise.next_angular_velocity} {
  if (promise.expiry > time_ + 2 * period_ + rounding) stay(promise.expiry);
}

void Driver::advance() {
  position_ += period_ * twist_.velocity;
  yaw_ = decision_yaw();
  time_ += period_;
  twist_ = next_;
  next_ = braking();
}

Twist Driver::facing(double yaw) const {
  return {Point2::Zero(), turning_to(yaw, twist_, decision_yaw(), limits_, period_)};
}

void Driver::stay(double until) {
  if (stands()) stays_until_ = std::max(stays_until_, until);
}

Promise Driver::promise() const {
  return {.stamp = time_,
          .position = position_,
          .velocity = twist_.velocity,
          .decision_time = time_ + period_,
          .next_velocity = next_.velocity,
          .expiry = std::max(time_ + 2 * period_, stays_until_),
          .yaw = yaw_,
          .angular_velocity = twist_.angular_velocity,
          .next_angular_velocity = next_.angular_velocity};
}

/// `suspect`: index of the neighbour that was in the way of the last twist. It probably blocks the next one
/// too, so it is checked first.
bool Driver::safe(const Twist& twist, std::span<const Neighbour> neighbours, const ClearanceField& field,
                  std::size_t& suspect) const {
  if (!clear_of_obstacles(decision_position(), twist, radius_, limits_, period_, field)) return false;
  const auto in_the_way = [&](std::span<const Neighbour> of) {
    return first_in_the_way(decision_position(), twist, time_ + period_, radius_, limits_, period_, of);
  };
  if (suspect < neighbours.size() && in_the_way(neighbours.subspan(suspect, 1)) == 0) return false;
  suspect = in_the_way(neighbours);
  return suspect == neighbours.size();
}

/// The velocity nearest to the preferred one that reciprocal velocity obstacles allow.
Point2 Driver::proposal(const Point2& preferred, std::span<const Neighbour> neighbours,
                        const ClearanceField& field) const {
  const double decision_time = time_ + period_;
  const MovingDisc self{decision_position(), twist_.velocity, radius_};
  std::vector<HalfPlane> obstacles;
  obstacle_half_planes(field, self.position, radius_, limits_.max_speed * obstacle_horizon, obstacle_horizon,
                       obstacles);
  std::vector<HalfPlane> robots;
  for (const Neighbour& n : neighbours) {
    const Promise& c = n.promise;
    const bool rests =
        c.velocity.isZero(0) && c.next_velocity.isZero(0) && c.expiry > decision_time + 2 * period_;
    const bool moves = !rests;
    const Point2 position =
        moves ? Point2(c.position_at_expiry() + (decision_time - c.expiry) * c.next_velocity)
              : c.position_at_expiry();
    const MovingDisc other{position, moves ? c.next_velocity : Point2::Zero(), n.radius};
    const double reach = radius_ + n.radius + horizon * (limits_.max_speed + n.limits.max_speed);
    if ((other.position - self.position).norm() > reach) continue;
    // A robot that stands leaves the whole change of velocity to this robot.
    robots.push_back(orca_half_plane(self, other, horizon, period_, moves ? 0.5 : 1.0));
  }
  return safe_velocity(preferred, limits_.max_speed, obstacles, robots);
}

/// The twist at the next turn whose velocity is closest to `wanted`.
Twist Driver::nearest_to(const Point2& wanted) const {
  if (is_differential(limits_)) return twist_towards(wanted, twist_, decision_yaw(), limits_, period_);
  return {within_limits(wanted, twist_.velocity, limits_, period_), 0};
}

/// Twists that the robot can take at its next turn, in all directions.
std::vector<Twist> Driver::around_present() const {
  if (is_differential(limits_)) return twists_after(twist_, decision_yaw(), limits_, period_);
  std::vector<Twist> twists;
  const double reach = std::min(limits_.max_acceleration * period_, limits_.max_speed);
  for (const double share : shares) {
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * std::numbers::pi * k / directions;
      const Point2 v = twist_.velocity + share * reach * Point2(std::cos(angle), std::sin(angle));
      if (v.norm() <= limits_.max_speed) twists.push_back({v, 0});
    }
  }
  return twists;
}

Twist Driver::evading(const Point2& preferred, std::span<const Neighbour> neighbours,
                      const ClearanceField& field) const {
  if (bound_to_stand()) return braking();
  const Point2 wanted = proposal(preferred, neighbours, field);
  const Twist nearest = nearest_to(wanted);
  std::size_t suspect = neighbours.size();
  if (safe(nearest, neighbours, field, suspect)) return nearest;

  std::vector<Twist> candidates = around_present();
  if (!is_differential(limits_)) candidates.push_back(twist_);
  std::ranges::sort(candidates, std::less{},
                    [&](const Twist& m) { return (m.velocity - wanted).squaredNorm(); });
  const auto first =
      std::ranges::find_if(candidates, [&](const Twist& m) { return safe(m, neighbours, field, suspect); });
  // The choice of the present twist has shown that braking is clear.
  return first != candidates.end() ? *first : braking();
}

bool Driver::is_blocked_by(const Neighbour& other, const Point2& wanted) const {
  return first_in_the_way(decision_position(), nearest_to(wanted), time_ + period_, radius_, limits_, period_,
                          {&other, 1}) == 0;
}

Point2 Driver::slow_to_turn(const Point2& wanted, double stray) const {
  const double speed = wanted.norm();
  if (!is_differential(limits_) || speed == 0) return wanted;
  const double angle = std::abs(wrapped(std::atan2(wanted.y(), wanted.x()) - decision_yaw()));
  const double drift = speed * angle * time_to_turn(angle, limits_);  // at the most
  return drift > stray ? Point2(wanted * (stray / drift)) : wanted;
}

Driver::Followed Driver::following(const Point2& wanted, std::span<const Neighbour> neighbours,
                                   const ClearanceField& field, const Allowed& allowed) const {
  if (bound_to_stand()) return {braking()};
  std::size_t suspect = neighbours.size();
  const auto may_take = [&](const Twist& m) { return allowed(m) && safe(m, neighbours, field, suspect); };
  const auto share = [&](double speed) { return nearest_to(speed * wanted); };
  for (const double speed : speeds) {
    if (const Twist fast = share(speed); may_take(fast)) return {fast};
  }
  std::vector<Twist> beside = around_present();
  std::erase_if(beside, [&](const Twist& m) {
    return m.velocity.norm() > wanted.norm() || m.velocity.dot(wanted) <= 0;
  });
  std::ranges::sort(beside, std::less{}, [&](const Twist& m) { return (m.velocity - wanted).squaredNorm(); });
  if (const auto first = std::ranges::find_if(beside, may_take); first != beside.end())
    return {*first, false};
  for (const double speed : low_speeds) {
    if (const Twist slow = share(speed); may_take(slow)) return {slow};
  }
  const Twist slow = share(low_speeds.back());
  const bool is_led =
      allowed(slow) && safe(slow, {}, field, suspect) && std::ranges::all_of(neighbours, [&](Neighbour n) {
        if (!n.promise.stands()) return true;
        n.promise.expiry = std::numeric_limits<double>::max();
        return safe(slow, {&n, 1}, field, suspect);
      });
  // Between obstacles without slack the robot must head exactly along its way before it can drive.
  const bool turns = is_differential(limits_) && braking().velocity.isZero(0) && !wanted.isZero(0);
  return {turns ? facing(std::atan2(wanted.y(), wanted.x())) : braking(), is_led};
}

/// On the line of the decision: one period with the twist, and then braking. A robot that curves would leave
/// it.
bool Driver::leads_out(const Twist& twist, const ClearanceField& field) const {
  if (std::abs(twist.angular_velocity) > straight) return false;
  const double speed = twist.velocity.norm();
  const double rest = period_ + speed / (2 * limits_.max_acceleration) + period_;
  return coppice::leads_out(field, decision_position(), decision_position() + rest * twist.velocity,
                            driving_radius(radius_, limits_));
}

std::optional<Twist> Driver::driving_out(const Point2& to, std::span<const Neighbour> neighbours,
                                         const ClearanceField& field) const {
  const Point2 way = to - decision_position();
  if (bound_to_stand() || field.is_free(decision_position(), driving_radius(radius_, limits_)))
    return braking();
  const double gap = way.norm();
  const double yaw = std::atan2(way.y(), way.x());
  const bool comes_to_stand = twist_.velocity.isZero(0) && braking().velocity.isZero(0);
  if (is_differential(limits_) && comes_to_stand && std::abs(wrapped(yaw - yaw_)) > faces) return facing(yaw);
  const double fast = std::min(limits_.max_speed, std::sqrt(limits_.max_acceleration * gap));
  for (const double share : {1.0, 0.5, 0.2, 0.05}) {
    const Twist twist = nearest_to(share * fast / gap * way);
    const bool is_clear = first_in_the_way(decision_position(), twist, time_ + period_, radius_, limits_,
                                           period_, neighbours) == neighbours.size();
    if (is_clear && leads_out(twist, field)) return twist;
  }
  return std::nullopt;
}

}  // namespace coppice
