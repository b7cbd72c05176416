#include "motion/body/braking_line.h"

#include <algorithm>
#include <cmath>

#include "motion/trajectory/segments.h"
#include "planning/geometry/free_way.h"

namespace coppice {

namespace {

// Metres between two robots beyond their radii: more than all rounding between sender, bus and record.
constexpr double margin = 0.001;

/// Whether a disc that moves from a0 to a1 between the times t0 and t1 stays clear of a neighbour.
class NeighbourRegion {
 public:
  NeighbourRegion(const Neighbour& neighbour, double own_radius, double period)
      : n_(neighbour),
        period_(period),
        reach_(own_radius + neighbour.radius + margin),
        at_decision_(n_.promise.position_at_decision()),
        at_expiry_(n_.promise.position_at_expiry()) {}

  bool clear(const Point2& a0, const Point2& a1, double t0, double t1) const {
    // The promise bends at `decision_time` and ends at `expiry`: each part of the interval is checked by
    // itself.
    double begin = t0;
    Point2 from = a0;
    for (const double cut : {n_.promise.decision_time, n_.promise.expiry, t1}) {
      const double end = std::clamp(cut, begin, t1);
      if (end == begin) continue;
      const Point2 to = a0 + (a1 - a0) * ((end - t0) / (t1 - t0));
      if (!clear_part(from, to, begin, end)) return false;
      begin = end;
      from = to;
    }
    return true;
  }

 private:
  /// Metres by which a robot may be away from where its velocity would have taken it. The velocity changes at
  /// the beginning of each period by at most the acceleration times the period, so the distance grows
  /// linearly in between.
  double drift_within(double seconds) const {
    const double begun = std::floor(seconds / period_);
    const double periods = begun * (begun + 1) / 2 + (begun + 1) * (seconds / period_ - begun);
    return n_.limits.max_acceleration * period_ * period_ * periods;
  }
  bool clear_part(const Point2& a0, const Point2& a1, double t0, double t1) const {
    const Promise& p = n_.promise;
    const double e = n_.clock_error;
    const double promised_speed = std::max(p.velocity.norm(), p.next_velocity.norm());
    if (t1 + e <= p.expiry) {
      const Point2 from = promised(t0);
      // A standing neighbour may stand closer than `reach_` by rounding. The robot may then still move away.
      const bool stands = promised_speed == 0 && !n_.doubtful;
      const double least = stands ? std::min(reach_, (a0 - from).norm()) : reach_ + e * promised_speed;
      return closest_approach(a0, a1, from, promised(t1)) >= least;
    }
    const double since = t1 + e - p.expiry;
    // With a clock error, the neighbour may still have its old velocity around its turn.
    const double before_decision =
        t0 < p.decision_time ? p.decision_time - p.stamp : std::min(e, p.decision_time - p.stamp);
    const double turned = e > 0 ? before_decision * (p.next_velocity - p.velocity).norm() : 0;
    const double drift = drift_within(since) + e * promised_speed + turned;
    if (closest_approach(a0, a1, ballistic(t0), ballistic(t1)) >= reach_ + drift) return true;
    const double free_reach = n_.limits.max_speed * std::max(since, p.expiry - t0 + e);
    return closest_approach(a0, a1, at_expiry_, at_expiry_) >= reach_ + free_reach;
  }

  Point2 promised(double t) const {
    const Promise& p = n_.promise;
    return t <= p.decision_time ? Point2(p.position + (t - p.stamp) * p.velocity)
                                : Point2(at_decision_ + (t - p.decision_time) * p.next_velocity);
  }
  Point2 ballistic(double t) const { return at_expiry_ + (t - n_.promise.expiry) * n_.promise.next_velocity; }

  const Neighbour& n_;
  double period_;
  double reach_;
  Point2 at_decision_;
  Point2 at_expiry_;
};

/// Metres that a neighbour may be away from its position at its stamp, until time `end`.
double furthest_from_its_stamp(const Neighbour& n, double end) {
  const Promise& p = n.promise;
  const double bound = std::max(0.0, std::min(end, p.expiry) - p.stamp);
  const double free = std::max(0.0, end - std::max(p.expiry, p.stamp));
  const double pace = std::sqrt(std::max(p.velocity.squaredNorm(), p.next_velocity.squaredNorm()));
  return pace * bound + n.limits.max_speed * (free + n.clock_error);
}

}  // namespace

std::size_t first_in_the_way(const Point2& position, const Twist& twist, double from, double radius,
                             const Limits& limits, double period, std::span<const Neighbour> neighbours) {
  const double speed = twist.velocity.norm();
  const double travel = speed * period + braking_distance(speed, limits, period);
  const int periods = 1 + braking_periods(speed, limits, period);
  const double end = from + periods * period;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const Neighbour& neighbour = neighbours[i];
    const double far = radius + neighbour.radius + margin + travel + furthest_from_its_stamp(neighbour, end);
    if ((position - neighbour.promise.position).squaredNorm() > far * far) continue;

    const NeighbourRegion region(neighbour, radius, period);
    Point2 here = position;
    Twist now = twist;
    double t = from;
    for (int k = 0; k < periods; ++k) {
      const Point2 next = here + period * now.velocity;
      if (!region.clear(here, next, t, t + period)) return i;
      here = next;
      t += period;
      now = braked(now, limits, period);
    }
  }
  return neighbours.size();
}

bool clear_of_obstacles(const Point2& position, const Twist& twist, double radius, const Limits& limits,
                        double period, const ClearanceField& field) {
  const Point2& velocity = twist.velocity;
  const double speed = velocity.norm();
  if (speed == 0) return true;
  if (twist.angular_velocity != 0) {
    Point2 here = position;
    for (Twist now = twist; !now.velocity.isZero(0); now = braked(now, limits, period)) {
      const Point2 next = here + period * now.velocity;
      if (!way_free(field, here, next, radius)) return false;
      here = next;
    }
    return true;
  }
  const double travel = speed * period + braking_distance(speed, limits, period);
  return way_free(field, position, position + velocity * (travel / speed), radius);
}

}  // namespace coppice
