#include "motion/trajectory/reserved_order.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

constexpr double piece_radii = 0.15;     // radii, length of the pieces into which the own way is cut
constexpr double least_crossing = 1e-3;  // sine of the angle of two ways: with less they count as parallel

constexpr double forever = std::numeric_limits<double>::infinity();

/// A part of a trajectory along which the robot drives straight, or stands: then its length is 0.
struct Part {
  Point2 from;
  Point2 direction;  ///< of length 1; 0 if the robot stands
  double length;
  double along;  ///< metres from the beginning of the trajectory
  double begin;  ///< seconds
  double end;

  double time(double metres) const { return begin + (end - begin) * metres / length; }
  double metres(double time) const { return length * std::clamp((time - begin) / (end - begin), 0.0, 1.0); }
  Point2 at(double metres) const { return from + metres * direction; }
};

/// With the times for which the robot stands at both ends.
std::vector<Part> parts_of(const Trajectory& trajectory, double offset) {
  std::vector<Part> parts;
  double along = 0;
  double since = -forever;
  for (std::size_t k = 1; k < trajectory.size(); ++k) {
    const Point2 way = trajectory[k].position - trajectory[k - 1].position;
    const double length = way.norm();
    if (length == 0) continue;
    const double begin = trajectory[k - 1].time + offset;
    if (begin > since) parts.push_back({trajectory[k - 1].position, Point2::Zero(), 0, along, since, begin});
    since = trajectory[k].time + offset;
    parts.push_back({trajectory[k - 1].position, way / length, length, along, begin, since});
    along += length;
  }
  parts.push_back({trajectory.back().position, Point2::Zero(), 0, along, since, forever});
  return parts;
}

bool come_near(const Part& a, const Part& b, double near) {
  const auto box = [](const Part& p) { return extended(Box<2>{p.from, p.from}, p.at(p.length)); };
  return distance(box(a), box(b)) < near;
}

/// Another's part, and the metres along an own part between which it may be near.
struct Close {
  const Part* other;
  double begin;
  double end;
};

/// None: the parts do not come near each other. The own part lies near the other's line, or near its point,
/// between two places.
std::optional<Close> close_to(const Part& own, const Part& other, double near) {
  if (!come_near(own, other, near)) return std::nullopt;
  const Point2 gap = own.from - other.from;
  double begin = 0;
  double end = own.length;
  if (own.length > 0 && other.length == 0) {
    if (std::abs(cross(own.direction, gap)) >= near) return std::nullopt;
    begin = std::max(begin, -gap.dot(own.direction) - near);
    end = std::min(end, -gap.dot(own.direction) + near);
  } else if (const double change = cross(other.direction, own.direction); std::abs(change) > least_crossing) {
    const double middle = -cross(other.direction, gap) / change;
    begin = std::max(begin, middle - near / std::abs(change));
    end = std::min(end, middle + near / std::abs(change));
  }
  return begin <= end ? std::optional(Close{&other, begin, end}) : std::nullopt;
}

/// The own robot is around p from `begin` to `end`. Raises `needed`, the metres along its way that the other
/// must have come before. Returns false if the two are close at the same time.
bool look_at(const Point2& p, double begin, double end, const Part& other, double near, double& needed) {
  const Point2 gap = other.from - p;
  const double along = gap.dot(other.direction);
  const double root = along * along - gap.squaredNorm() + near * near;
  if (root <= 0) return true;
  if (other.length == 0) return other.end <= begin || other.begin >= end;
  const double first = std::max(0.0, -along - std::sqrt(root));
  const double last = std::min(other.length, -along + std::sqrt(root));
  if (first >= last || other.time(first) >= end) return true;
  const bool over = other.time(last) <= begin;
  // If the two are close at that time, each lets the other be a little ahead.
  const double passed = over ? last : other.metres(begin - room_in_time);
  if (passed > first) needed = std::max(needed, other.along + passed);
  return over;
}

/// Metres along a way at a time.
double metres_at(const std::vector<Part>& parts, double time) {
  const auto part = std::ranges::find_if(parts, [&](const Part& p) { return time <= p.end; });
  return part->along + (part->length > 0 ? part->metres(time) : 0);
}

/// Where a robot is from one time to another. Either robot may go ahead of its trajectory by the room in
/// time: so the two keep apart only up to where it is that long before.
void add_stretch(const std::vector<Part>& parts, double from, double until, std::vector<Stretch>& stretches) {
  const Stretch stretch{metres_at(parts, from - room_in_time), metres_at(parts, until)};
  if (!stretches.empty() && stretch.begin <= stretches.back().end) {
    stretches.back().end = std::max(stretches.back().end, stretch.end);
  } else {
    stretches.push_back(stretch);
  }
}

}  // namespace

double beyond(std::span<const Stretch> parts) {
  double end = -1;
  for (const Stretch& part : parts) end = std::max(end, part.end);
  return end;
}

Order order_of(const Trajectory& own, double own_radius, const Trajectory& other, double other_radius,
               double offset) {
  const double piece = piece_radii * own_radius;
  const double slack = gate_slack_radii * std::max(own_radius, other_radius);
  const double near = (1 + reserved_stray_radii) * (own_radius + other_radius) + piece / 2 + slack;
  const std::vector<Part> others = parts_of(other, offset);
  std::vector<Close> close;
  Order order;
  double needed = 0;
  const std::vector<Part> parts = parts_of(own, 0);
  for (const Part& part : parts) {
    close.clear();
    for (const Part& o : others) {
      if (const auto c = close_to(part, o, near)) close.push_back(*c);
    }
    if (close.empty()) continue;
    const double pieces = std::max(1.0, std::ceil(part.length / piece));
    const double step = part.length / pieces;
    const double begin = std::ranges::min(close, {}, &Close::begin).begin;
    const double end = std::ranges::max(close, {}, &Close::end).end;
    const double first = step > 0 ? std::min(std::floor(begin / step), pieces - 1) : 0;
    for (double k = first; k < pieces && (k == first || k * step <= end); ++k) {
      const double from = step * k;
      const double to = step * (k + 1);
      const bool moves = part.length > 0;
      const double before = needed;
      for (const Close& o : close) {
        if (to < o.begin || from > o.end) continue;
        const double since = moves ? part.time(from) : part.begin;
        const double until = moves ? part.time(to) : part.end;
        if (look_at(part.at((from + to) / 2), since, until, *o.other, near, needed)) continue;
        add_stretch(parts, since, until, order.too_close);
        add_stretch(others, since, until, order.other_too_close);
      }
      if (needed > before) order.gates.push_back({part.along + from, needed});
    }
  }
  return order;
}

}  // namespace coppice
