#include "motion/body/way_follower.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "motion/trajectory/corner_speed.h"
#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

constexpr double look_ahead_radii = 0.25;   // radii to the point for which the robot heads, at least
constexpr double turning_time = 0.35;       // seconds to that point, of a robot that turns
constexpr double least_look_ahead = 0.001;  // share of the usual one
// Radii; window of the search for the nearest point of the way, beyond what the robot drives in a period.
constexpr double window_radii = 2;
constexpr double there_radii = 0.01;  // radii within which a robot counts as having reached a point

/// Joins the legs to one way. Each must begin where the previous one ends.
Path joined(std::span<const Path> legs) {
  Path way{legs.front().front()};
  for (const Path& leg : legs) way.insert(way.end(), leg.begin() + 1, leg.end());
  return way;
}

}  // namespace

WayFollower::WayFollower(std::span<const Path> legs, double radius, double stray)
    : way_(joined(legs)), radius_(radius), stray_(stray) {
  std::size_t end = 0;
  arcs_.resize(way_.points.size());
  for (std::size_t i = 1; i + 1 < arcs_.size(); ++i) arcs_[i] = arc_at(i);
  for (const Path& leg : legs) {
    leg_ends_.push_back(way_.along[end += leg.size() - 1]);
    arcs_[end] = {};
  }
}

/// Metres along the way up to which the robot, at this position, may have come from `from`. A fast robot
/// drives many radii in a period.
double WayFollower::window_end(const Point2& position, double from) const {
  const double driven = (position - way_.at(from)).norm();
  return std::min(from + window_radii * radius_ + driven, leg_ends_[leg_]);
}

/// Metres along the way to the point of the leg, within the window, that is nearest to a position; never
/// back.
double WayFollower::nearest(const Point2& position, double from) const {
  const double end = window_end(position, from);
  const auto first = std::upper_bound(way_.along.begin(), way_.along.end(), from);
  double best = from;
  double best_distance = (way_.at(from) - position).norm();
  for (auto i = static_cast<std::size_t>(first - way_.along.begin());
       i < way_.points.size() && way_.along[i - 1] < end; ++i) {
    const Point2 edge = way_.points[i] - way_.points[i - 1];
    const double squared = edge.squaredNorm();
    if (squared == 0) continue;
    const double share = std::clamp((position - way_.points[i - 1]).dot(edge) / squared, 0.0, 1.0);
    const double along = way_.along[i - 1] + share * (way_.along[i] - way_.along[i - 1]);
    const double distance = (way_.points[i - 1] + share * edge - position).norm();
    if (along > from && along <= end && distance < best_distance) {
      best = along;
      best_distance = distance;
    }
  }
  return best;
}

/// The next leg begins when the end of this one is reached.
void WayFollower::come_to(const Point2& position) {
  const double before = progress_;
  progress_ = nearest(position, before);
  if (window_end(position, before) == leg_ends_[leg_] &&
      (way_.at(leg_ends_[leg_]) - position).norm() <= there_radii * radius_) {
    progress_ = leg_ends_[leg_];
    if (leg_ + 1 < leg_ends_.size()) ++leg_;
  }
}

/// The points within a distance of an edge are a convex set. So a line is in the strip if both ends lie by
/// the same edge, or if that holds for each of its halves.
bool WayFollower::in_strip(const Point2& a, const Point2& b, double from, int halvings) const {
  const double behind = std::max(0.0, from - radius_);
  const double ahead = window_end(b, from);
  const auto first = std::upper_bound(way_.along.begin(), way_.along.end(), behind);
  for (auto i = static_cast<std::size_t>(first - way_.along.begin());
       i < way_.points.size() && way_.along[i - 1] <= ahead; ++i) {
    if (point_segment_distance(a, way_.points[i - 1], way_.points[i]) <= stray_ &&
        point_segment_distance(b, way_.points[i - 1], way_.points[i]) <= stray_)
      return true;
  }
  if (halvings == 0) return false;
  const Point2 middle = 0.5 * (a + b);
  return in_strip(a, middle, from, halvings - 1) && in_strip(middle, b, from, halvings - 1);
}

std::optional<double> WayFollower::along_strip(const Point2& a, const Point2& b, double from) const {
  constexpr int halvings = 5;
  constexpr double rounding = 1e-6;
  if (!in_strip(a, b, from, halvings)) return std::nullopt;
  const double along = nearest(b, from);
  return (way_.at(along) - b).norm() <= stray_ + rounding ? std::optional(along) : std::nullopt;
}

double WayFollower::stop_before(const Point2& point, double touching, double kept, double ahead) const {
  constexpr double never = std::numeric_limits<double>::infinity();
  const double end = std::min(progress_ + ahead, way_.length());
  const auto first = std::upper_bound(way_.along.begin(), way_.along.end(), progress_);
  double comes_near = never;
  Point2 from = way_.at(progress_);
  double along = progress_;
  for (auto i = static_cast<std::size_t>(first - way_.along.begin()); i < way_.points.size() && along < end;
       ++i) {
    const Point2 to = way_.at(std::min(way_.along[i], end));
    const std::optional<Chord> near = chord_in_disc(from, to, point, kept);
    if (!near || near->begin > 0) comes_near = never;
    if (near && comes_near == never) comes_near = along + near->begin;
    if (chord_in_disc(from, to, point, touching)) return comes_near;
    if (near && near->end < (to - from).norm()) comes_near = never;
    from = to;
    along = way_.along[i];
  }
  return never;
}

bool WayFollower::finished() const {
  return progress_ == way_.length();
}

/// Each of an edge's two corners may use half of the edge.
WayFollower::Arc WayFollower::arc_at(std::size_t corner) const {
  const Point2 in = way_.points[corner] - way_.points[corner - 1];
  const Point2 out = way_.points[corner + 1] - way_.points[corner];
  const double infinity = std::numeric_limits<double>::infinity();
  if (in.isZero(0) || out.isZero(0)) return {infinity, 0, 0};
  const double bend = std::acos(std::clamp(in.normalized().dot(out.normalized()), -1.0, 1.0));
  const double tangent = std::tan(bend / 2);
  if (tangent < 1e-6) return {infinity, 0, 0};
  const double room = std::min(in.norm(), out.norm()) / (2 * tangent);
  const double radius = std::min(arc_radius(in.normalized(), out.normalized(), stray_), room);
  return {radius, bend, radius * tangent};
}

/// The point at `along` metres of the way with rounded corners.
Point2 WayFollower::rounded_at(double along) const {
  const Point2 sharp = way_.at(along);
  const auto next = std::upper_bound(way_.along.begin(), way_.along.end(), along) - way_.along.begin();
  for (auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - 1, 1));
       i <= static_cast<std::size_t>(next) && i + 1 < way_.points.size(); ++i) {
    const Arc& arc = arcs_[i];
    const double from = way_.along[i] - arc.tangent;
    if (along <= from || along >= way_.along[i] + arc.tangent) continue;
    const Point2 in = (way_.points[i] - way_.points[i - 1]).normalized();
    const Point2 out = (way_.points[i + 1] - way_.points[i]).normalized();
    const Point2 inwards = (out - in.dot(out) * in).normalized();
    const double angle = arc.bend * (along - from) / (2 * arc.tangent);
    return way_.points[i] - arc.tangent * in +
           arc.radius * (std::sin(angle) * in + (1 - std::cos(angle)) * inwards);
  }
  return sharp;
}

double WayFollower::speed_limit(double stop, const Limits& limits, double period) const {
  const double left = std::max(0.0, stop - progress_);
  // A robot can stop at once from this speed, so it drives what is left in one period.
  const double last = std::min(limits.max_acceleration * period, left / period);
  double speed = std::min(limits.max_speed, std::max(last, speed_to_stop_within(left, limits, period)));
  const double far = limits.max_speed * limits.max_speed / (2 * limits.max_acceleration);
  const auto first = std::upper_bound(way_.along.begin(), way_.along.end(), progress_);
  for (auto i = static_cast<std::size_t>(first - way_.along.begin());
       i + 1 < way_.points.size() && way_.along[i] - arcs_[i].tangent < progress_ + far; ++i) {
    const double on_arc =
        std::max(limits.max_acceleration * period, speed_on_arc(arcs_[i].radius, stray_, limits, period));
    const double room = std::max(0.0, way_.along[i] - progress_ - arcs_[i].tangent);
    speed = std::min(speed, std::sqrt(on_arc * on_arc + 2 * limits.max_acceleration * room));
  }
  return speed;
}

/// Metres ahead to the point for which the robot heads: it stays in the strip on a straight line there.
double WayFollower::look_ahead_in_strip(const Point2& position, double usual) const {
  constexpr int halvings = 4;
  double ahead = look_ahead_ * usual;
  for (int k = 0; k < halvings && !in_strip(position, rounded_at(progress_ + ahead), progress_, halvings);
       ++k)
    ahead /= 2;
  return ahead;
}

Point2 WayFollower::preferred_velocity(const Point2& position, const Limits& limits, double period,
                                       double open) const {
  const double slack = there_radii * radius_;
  const double stop = std::min(open, leg_ends_[leg_]);
  // A robot drives no further in a period than to the point for which it heads. A robot that turns to it
  // needs time for that, or it weaves along its way.
  const double time_ahead = is_differential(limits) ? turning_time : period;
  const double usual = std::max(look_ahead_radii * radius_, limits.max_speed * time_ahead);
  // Where it is to stop, the robot drives to the way itself: it has come so far then.
  const double ahead = progress_ + look_ahead_in_strip(position, usual);
  const Point2 gap = (ahead < stop ? rounded_at(ahead) : way_.at(stop)) - position;
  const double distance = gap.norm();
  if (stop <= progress_ - slack || distance <= 1e-9) return Point2::Zero();
  // The robot must not drive past the point for which it heads: in a passage without slack it would hit the
  // wall.
  const double speed =
      std::min(speed_limit(std::max(stop, progress_ + distance), limits, period), distance / period);
  return gap * (speed / distance);
}

void WayFollower::led_past(bool everything) {
  look_ahead_ = everything ? std::min(look_ahead_ * 2, 1.0) : std::max(look_ahead_ / 2, least_look_ahead);
}

}  // namespace coppice
