#include "motion/way_follower.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace coppice {

namespace {

constexpr double look_ahead_radii = 0.25;  // radii to the point for which the robot heads
constexpr double least_look_ahead_radii = 0.0002;
constexpr double window_radii = 2;     // radii; window of the search for the nearest point of the way
constexpr double braking_share = 0.5;  // share of the acceleration for braking; the rest is for turning
constexpr double there_radii = 0.01;   // radii within which a robot counts as having reached a point

/// Joins the legs to one way. Each must begin where the previous one ends.
Path joined(std::span<const Path> legs) {
  Path way{legs.front().front()};
  for (const Path& leg : legs) way.insert(way.end(), leg.begin() + 1, leg.end());
  return way;
}

}  // namespace

WayFollower::WayFollower(std::span<const Path> legs, std::vector<Gate> gates, double radius)
    : way_(joined(legs)), gates_(std::move(gates)), radius_(radius), look_ahead_(look_ahead_radii * radius) {
  std::size_t end = 0;
  for (const Path& leg : legs) leg_ends_.push_back(way_.along[end += leg.size() - 1]);
}

/// Advances to the nearest point of the leg within the window, never back. The next leg begins when the end
/// of this one is reached.
void WayFollower::advance_progress(const Point2& position) {
  const double window_end = std::min(progress_ + window_radii * radius_, leg_ends_[leg_]);
  const auto first = std::upper_bound(way_.along.begin(), way_.along.end(), progress_);
  double best = progress_;
  double best_distance = (way_.at(progress_) - position).norm();
  for (auto i = static_cast<std::size_t>(first - way_.along.begin());
       i < way_.points.size() && way_.along[i - 1] < window_end; ++i) {
    const Point2 edge = way_.points[i] - way_.points[i - 1];
    const double squared = edge.squaredNorm();
    if (squared == 0) continue;
    const double share = std::clamp((position - way_.points[i - 1]).dot(edge) / squared, 0.0, 1.0);
    const double along = way_.along[i - 1] + share * (way_.along[i] - way_.along[i - 1]);
    const double distance = (way_.points[i - 1] + share * edge - position).norm();
    if (along > progress_ && along <= window_end && distance < best_distance) {
      best = along;
      best_distance = distance;
    }
  }
  progress_ = best;
  if (window_end == leg_ends_[leg_] &&
      (way_.at(leg_ends_[leg_]) - position).norm() <= there_radii * radius_) {
    progress_ = leg_ends_[leg_];
    if (leg_ + 1 < leg_ends_.size()) ++leg_;
  }
}

bool WayFollower::finished() const {
  return progress_ == way_.length();
}

/// The speed at which an arc that strays by no more than is allowed takes the robot around the corner.
double WayFollower::corner_speed(std::size_t corner, const Limits& limits, double period) const {
  const double turns_at_once = limits.max_acceleration * period;
  const Point2 in = way_.points[corner] - way_.points[corner - 1];
  const Point2 out = way_.points[corner + 1] - way_.points[corner];
  const double lengths = in.norm() * out.norm();
  if (lengths == 0) return limits.max_speed;
  // The cosine of half of the turn. The arc of radius R that touches both edges strays by R (1 / cos - 1)
  // from the corner, and begins R tan before it. Each of an edge's two corners may use half of the edge.
  const double cosine = std::sqrt(std::max(0.0, (1 + in.dot(out) / lengths) / 2));
  if (cosine < 1e-6) return turns_at_once;
  const double stray = 1 / cosine - 1;
  if (stray < 1e-9) return limits.max_speed;
  const double tangent = std::sqrt(1 - cosine * cosine) / cosine;
  const double arc = std::min(stray_radii * radius_ / stray, std::min(in.norm(), out.norm()) / (2 * tangent));
  return std::max(turns_at_once, std::sqrt(limits.max_acceleration * braking_share * arc));
}

double WayFollower::speed_limit(double stop, const Limits& limits, double period) const {
  const Limits braking{limits.max_speed, braking_share * limits.max_acceleration};
  double speed = std::min(limits.max_speed, speed_to_stop_within(stop - progress_, limits, period));
  const double far = limits.max_speed * limits.max_speed / (2 * braking.max_acceleration);
  const auto first = std::upper_bound(way_.along.begin(), way_.along.end(), progress_);
  for (auto i = static_cast<std::size_t>(first - way_.along.begin());
       i + 1 < way_.points.size() && way_.along[i] < progress_ + far; ++i) {
    const double corner = corner_speed(i, limits, period);
    const double room = std::max(0.0, way_.along[i] - progress_ - look_ahead_);
    speed = std::min(speed, std::sqrt(corner * corner + 2 * braking.max_acceleration * room));
  }
  return speed;
}

Point2 WayFollower::preferred_velocity(const Point2& position, const Limits& limits, double period,
                                       const std::function<double(std::size_t)>& passed) {
  advance_progress(position);
  const double slack = there_radii * radius_;
  double ahead = 0;  // metres that the next gate's robot has still to drive
  for (; next_gate_ < gates_.size(); ++next_gate_) {
    ahead = gates_[next_gate_].needed - passed(gates_[next_gate_].robot);
    if (ahead > slack) break;
  }
  const double gate = next_gate_ < gates_.size() ? gates_[next_gate_].at : way_.length();
  const double stop = std::min(gate, leg_ends_[leg_]);
  waits_for_ = next_gate_ < gates_.size() && gate - progress_ < slack
                   ? std::optional(Wait{gates_[next_gate_].robot, ahead})
                   : std::nullopt;
  const Point2 gap = way_.at(std::min(progress_ + look_ahead_, stop)) - position;
  const double distance = gap.norm();
  if (stop <= progress_ - slack || distance <= 1e-9) return Point2::Zero();
  // The robot must not drive past the point for which it heads: in a passage without slack it would hit the
  // wall.
  const double speed =
      std::min(speed_limit(std::max(stop, progress_ + distance), limits, period), distance / period);
  return gap * (speed / distance);
}

void WayFollower::led_past(bool everything) {
  look_ahead_ = everything ? std::min(look_ahead_ * 2, look_ahead_radii * radius_)
                           : std::max(look_ahead_ / 2, least_look_ahead_radii * radius_);
}

}  // namespace coppice
