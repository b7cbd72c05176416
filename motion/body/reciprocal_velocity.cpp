#include "coppice/motion/reciprocal_velocity.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace coppice {
namespace {

constexpr double precision = 1e-9;  // m/s, and m in comparisons of obstacles

Point2 left_of(const Point2& v) {
  return {-v.y(), v.x()};
}
Point2 right_of(const Point2& v) {
  return {v.y(), -v.x()};
}

/// The normal that points away from the forbidden side.
Point2 inward(const HalfPlane& plane) {
  return left_of(plane.direction);
}

/// v / |v|. If v is too small to have a direction, the direction of `otherwise`, and then x.
Point2 direction_of(const Point2& v, const Point2& otherwise) {
  constexpr double nothing = std::numeric_limits<double>::min();
  if (const double length = v.norm(); length > nothing) return v / length;
  if (const double length = otherwise.norm(); length > nothing) return otherwise / length;
  return Point2::UnitX();
}

/// The smallest change that brings a relative velocity out of the velocity obstacle, and the outward normal
/// there.
struct WayOut {
  Point2 change;
  Point2 normal;
};

/// The way out of the disc of velocities that lead to an overlap exactly after `time`.
WayOut out_of_disc(const Point2& offset, const Point2& velocity, double radius, double time) {
  const Point2 from_centre = velocity - offset / time;
  const Point2 normal = direction_of(from_centre, -offset);
  return {(radius / time - from_centre.norm()) * normal, normal};
}

/// The way over the nearer leg of the cone of velocities that lead to an overlap at any time. Straight ahead
/// counts as right, for both discs.
WayOut over_leg(const Point2& offset, const Point2& velocity, double radius) {
  const double squared = offset.squaredNorm();
  const double leg = std::sqrt(squared - radius * radius);
  const double side = cross(offset, velocity) > 0 ? 1.0 : -1.0;
  const Point2 along = (leg * offset + side * radius * left_of(offset)) / squared;
  const Point2 normal = side * left_of(along);
  return {-velocity.dot(normal) * normal, normal};
}

WayOut way_out(const Point2& offset, const Point2& velocity, double radius, double horizon,
               double time_step) {
  const double squared = offset.squaredNorm();
  if (squared <= radius * radius) return out_of_disc(offset, velocity, radius, time_step);
  // The truncated cone ends in a disc. Its cap lies between the points where the legs touch the disc.
  const Point2 from_centre = velocity - offset / horizon;
  const double ahead = from_centre.dot(offset);
  const bool at_cap = ahead < 0 && ahead * ahead > radius * radius * from_centre.squaredNorm();
  return at_cap ? out_of_disc(offset, velocity, radius, horizon) : over_leg(offset, velocity, radius);
}

/// An aim of the optimisation: the velocity nearest to a target.
struct NearestTo {
  Point2 target;
  Point2 within(double max_speed) const {
    const double speed = target.norm();
    return speed <= max_speed ? target : Point2(target * (max_speed / speed));
  }
  double on(const HalfPlane& line, double from, double to) const {
    return std::clamp(line.direction.dot(target - line.point), from, to);
  }
};

/// An aim of the optimisation: the velocity furthest along a direction.
struct FurthestAlong {
  Point2 direction;
  Point2 within(double max_speed) const { return max_speed * direction; }
  double on(const HalfPlane& line, double from, double to) const {
    return line.direction.dot(direction) > 0 ? to : from;
  }
};

/// The best velocity on the edge of `line` within max_speed and the half planes at(0), ..., at(count - 1).
template <class Aim, class PlaneAt>
std::optional<Point2> best_on_line(const HalfPlane& line, const Aim& aim, double max_speed, std::size_t count,
                                   const PlaneAt& at) {
  const double middle = -line.point.dot(line.direction);
  const double off_centre = cross(line.direction, line.point);
  if (std::abs(off_centre) > max_speed + precision) return std::nullopt;
  const double half_chord = std::sqrt(std::max(0.0, max_speed * max_speed - off_centre * off_centre));
  double from = middle - half_chord;
  double to = middle + half_chord;
  for (std::size_t k = 0; k < count; ++k) {
    const HalfPlane plane = at(k);
    const double room = -violation(plane, line.point);
    const double loss = cross(line.direction, plane.direction);  // loss of room for each m/s along the line
    if (std::abs(loss) <= precision) {
      if (room < -precision) return std::nullopt;
      continue;
    }
    if (loss > 0) {
      to = std::min(to, room / loss);
    } else {
      from = std::max(from, room / loss);
    }
    if (from > to + precision) return std::nullopt;
  }
  return line.point + aim.on(line, from, std::max(from, to)) * line.direction;
}

struct Optimum {
  Point2 velocity;
  std::size_t held;  // the half planes before this index hold; the velocity is the best for them
};

/// The best velocity within max_speed and at(0), ..., at(count - 1). If these cannot hold together, the best
/// within as many of the first ones as can.
template <class Aim, class PlaneAt>
Optimum best_within(const Aim& aim, double max_speed, std::size_t count, const PlaneAt& at) {
  Point2 best = aim.within(max_speed);
  for (std::size_t k = 0; k < count; ++k) {
    const HalfPlane plane = at(k);
    if (violation(plane, best) <= precision) continue;
    const std::optional<Point2> next = best_on_line(plane, aim, max_speed, k, at);
    if (!next) return {best, k};
    best = *next;
  }
  return {best, count};
}

/// The half plane of the velocities, up to max_speed, that violate `one` no more than `other`.
HalfPlane no_worse(const HalfPlane& one, const HalfPlane& other, double max_speed) {
  const Point2 difference = inward(one) - inward(other);
  const double length = difference.norm();
  if (length <= precision) {
    // The planes are parallel, and `one` holds better everywhere: `other` is examined because it was violated
    // more.
    return {-max_speed * inward(one), one.direction};
  }
  const Point2 normal = difference / length;
  const double offset = (inward(one).dot(one.point) - inward(other).dot(other.point)) / length;
  return {offset * normal, right_of(normal)};
}

/// Starts from a velocity within the hard half planes and within the soft ones before `first`. Returns one
/// within the hard half planes for which the largest violation of a soft one is as small as possible.
Point2 least_violating(Point2 velocity, double max_speed, std::span<const HalfPlane> hard,
                       std::span<const HalfPlane> soft, std::size_t first) {
  double worst = 0;
  for (std::size_t i = first; i < soft.size(); ++i) {
    if (violation(soft[i], velocity) <= worst + precision) continue;
    const auto at = [&](std::size_t k) {
      return k < hard.size() ? hard[k] : no_worse(soft[k - hard.size()], soft[i], max_speed);
    };
    const std::size_t count = hard.size() + i;
    const Optimum least = best_within(FurthestAlong{inward(soft[i])}, max_speed, count, at);
    // The current velocity lies within all of them except for rounding. If no better one is found, it is the
    // best.
    if (least.held == count) velocity = least.velocity;
    worst = violation(soft[i], velocity);
  }
  return velocity;
}

/// A tangent of the free region around p: blocked cells lie at or beyond `distance` (metres) along the
/// normal.
struct Tangent {
  Point2 normal;
  double distance;

  bool hides(const Box<2>& square, const Point2& p) const {
    const Point2 nearest = (normal.array() > 0).select(square.lower, square.upper) - p;
    return nearest.dot(normal) >= distance - precision;
  }
};

/// The half plane of velocities that keep the disc behind the tangent. If the tangent cuts the disc, this
/// would ask the disc to back off.
HalfPlane half_plane_of(const Tangent& tangent, double radius, double horizon) {
  return {(tangent.distance - radius) / horizon * tangent.normal, left_of(tangent.normal)};
}

Tangent tangent_of(const HalfPlane& plane, double radius, double horizon) {
  const Point2 normal = right_of(plane.direction);
  return {normal, radius + horizon * plane.point.dot(normal)};
}

/// A blocked square near p. Nearer squares come first; squares at equal distance keep the order in which they
/// are found.
struct Candidate {
  double squared_distance;
  std::size_t number;
  Box<2> square;
  bool before(const Candidate& other) const {
    return squared_distance < other.squared_distance ||
           (squared_distance == other.squared_distance && number < other.number);
  }
};

Point2 offset_to(const Box<2>& square, const Point2& p) {
  return p.cwiseMax(square.lower).cwiseMin(square.upper) - p;
}

Tangent tangent_at(const Box<2>& square, const Point2& p) {
  const Point2 offset = offset_to(square, p);
  return {direction_of(offset, 0.5 * (square.lower + square.upper) - p), offset.norm()};
}

void append_border(const Box<2>& bounds, const Point2& p, double radius, double range, double horizon,
                   std::vector<HalfPlane>& out) {
  const auto append = [&](double distance, const Point2& normal) {
    if (distance < range) out.push_back(half_plane_of({normal, distance}, radius, horizon));
  };
  append(p.x() - bounds.lower.x(), -Point2::UnitX());
  append(p.y() - bounds.lower.y(), -Point2::UnitY());
  append(bounds.upper.x() - p.x(), Point2::UnitX());
  append(bounds.upper.y() - p.y(), Point2::UnitY());
}

/// The next square after `last`, within `range`, that no tangent of `planes` hides.
std::optional<Candidate> next_unhidden(const ClearanceField& field, const Point2& p, double radius,
                                       double range, double horizon, const Candidate& last,
                                       std::span<const HalfPlane> planes) {
  std::optional<Candidate> next;
  std::size_t number = 0;
  field.for_each_edge_near(p, range, [&](const Box<2>& square) {
    const Candidate candidate{offset_to(square, p).squaredNorm(), ++number, square};
    if (candidate.squared_distance >= range * range || !last.before(candidate)) return;
    if (next && !candidate.before(*next)) return;
    for (const HalfPlane& plane : planes) {
      if (tangent_of(plane, radius, horizon).hides(square, p)) return;
    }
    next = candidate;
  });
  return next;
}

}  // namespace

double violation(const HalfPlane& plane, const Point2& velocity) {
  return cross(plane.direction, plane.point - velocity);
}

HalfPlane orca_half_plane(const MovingDisc& self, const MovingDisc& other, double horizon, double time_step,
                          double responsibility) {
  const WayOut out = way_out(other.position - self.position, self.velocity - other.velocity,
                             self.radius + other.radius, horizon, time_step);
  return {self.velocity + responsibility * out.change, right_of(out.normal)};
}

void obstacle_half_planes(const ClearanceField& field, const Point2& p, double radius, double reach,
                          double horizon, std::vector<HalfPlane>& out) {
  if (field.lower_bound(p) >= radius + reach) return;
  radius += field.inflation();
  const double range = radius + reach;
  const std::size_t first = out.size();
  append_border(field.bounds(), p, radius, range, horizon, out);
  Candidate last{-1, 0, {}};
  const auto planes = [&] { return std::span(out).subspan(first); };
  while (const auto next = next_unhidden(field, p, radius, range, horizon, last, planes())) {
    out.push_back(half_plane_of(tangent_at(next->square, p), radius, horizon));
    last = *next;
  }
  // Standing still is always allowed.
  for (HalfPlane& plane : planes()) {
    if (violation(plane, Point2::Zero()) > 0) plane.point.setZero();
  }
}

Point2 safe_velocity(const Point2& preferred, double max_speed, std::span<const HalfPlane> hard,
                     std::span<const HalfPlane> soft) {
  assert(std::ranges::all_of(
      hard, [](const HalfPlane& plane) { return violation(plane, Point2::Zero()) <= precision; }));
  const auto at = [&](std::size_t k) { return k < hard.size() ? hard[k] : soft[k - hard.size()]; };
  const std::size_t count = hard.size() + soft.size();
  const Optimum nearest = best_within(NearestTo{preferred}, max_speed, count, at);
  if (nearest.held == count) return nearest.velocity;
  // Standing still is within all hard half planes. Only rounding can make them seem to have no common
  // velocity.
  if (nearest.held < hard.size()) return Point2::Zero();
  return least_violating(nearest.velocity, max_speed, hard, soft, nearest.held - hard.size());
}

}  // namespace coppice
