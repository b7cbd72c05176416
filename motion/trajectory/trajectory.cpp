#include "coppice/motion/trajectory.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

/// Follows a trajectory in time, forwards.
class Walk {
 public:
  explicit Walk(const Trajectory& trajectory) : trajectory_(trajectory) {}

  /// The time of the first point after `time`; infinite: there is none.
  double next_after(double time) {
    while (next_ < trajectory_.size() && trajectory_[next_].time <= time) ++next_;
    return next_ < trajectory_.size() ? trajectory_[next_].time : std::numeric_limits<double>::infinity();
  }
  /// `time` is between the point before the one that next_after() told last, and that one.
  Point2 at(double time) const {
    if (next_ == 0) return trajectory_.front().position;
    const TimedPoint& before = trajectory_[next_ - 1];
    if (next_ == trajectory_.size()) return before.position;
    const TimedPoint& next = trajectory_[next_];
    const double share = (time - before.time) / (next.time - before.time);
    return before.position + std::clamp(share, 0.0, 1.0) * (next.position - before.position);
  }

 private:
  const Trajectory& trajectory_;
  std::size_t next_ = 0;
};

}  // namespace

Trajectory rest_of(const Trajectory& trajectory, double along) {
  double left = std::max(0.0, along);
  for (std::size_t k = 1; k < trajectory.size(); ++k) {
    const TimedPoint& from = trajectory[k - 1];
    const Point2 leg = trajectory[k].position - from.position;
    if (left >= leg.norm()) {
      left -= leg.norm();
      continue;
    }
    const double share = left / leg.norm();
    Trajectory rest{{from.time + share * (trajectory[k].time - from.time), from.position + share * leg}};
    rest.insert(rest.end(), trajectory.begin() + static_cast<std::ptrdiff_t>(k), trajectory.end());
    return rest;
  }
  return {trajectory.back()};
}

bool come_too_close(const Trajectory& a, const Trajectory& b, double near, double from) {
  Walk walk_a(a);
  Walk walk_b(b);
  for (double time = from;;) {
    const double until = std::min(walk_a.next_after(time), walk_b.next_after(time));
    if (until == std::numeric_limits<double>::infinity())
      return (walk_a.at(time) - walk_b.at(time)).norm() < near;
    if (closest_approach(walk_a.at(time), walk_a.at(until), walk_b.at(time), walk_b.at(until)) < near)
      return true;
    time = until;
  }
}

}  // namespace coppice
