#include "motion/body/path_follower.h"

#include <algorithm>

#include "planning/geometry/free_way.h"

namespace coppice {

namespace {

// How far ahead the point lies for which the robot heads: far enough to cut corners smoothly, near enough
// that a robot that was pushed aside comes back to its path. Seconds at full speed; at least so many radii.
constexpr double look_ahead_seconds = 1.5;
constexpr double least_look_ahead_radii = 2;
// How far ahead of the last projection onto the path the next one is searched, in radii. Where a path passes
// near itself, the robot is not projected onto the later part.
constexpr double projection_window_radii = 8;
constexpr int halvings = 6;

}  // namespace

Path PathFollower::rest() const {
  Path rest{path_.at(seen_)};
  for (std::size_t i = 0; i < path_.points.size(); ++i) {
    if (path_.along[i] > seen_) rest.push_back(path_.points[i]);
  }
  return rest;
}

double PathFollower::way_left(const Point2& position) const {
  const double along = nearest(position, path_.length());
  return (path_.at(along) - position).norm() + path_.length() - along;
}

/// Distance along the path to its nearest point between the last progress and `window_end`.
double PathFollower::nearest(const Point2& position, double window_end) const {
  double best = progress_;
  double best_distance = (path_.at(progress_) - position).squaredNorm();
  for (std::size_t i = 1; i < path_.points.size(); ++i) {
    if (path_.along[i] < progress_ || path_.along[i - 1] > window_end) continue;
    const Point2 edge = path_.points[i] - path_.points[i - 1];
    const double squared = edge.squaredNorm();
    if (squared == 0) continue;
    const double share = std::clamp((position - path_.points[i - 1]).dot(edge) / squared, 0.0, 1.0);
    const double along = path_.along[i - 1] + share * (path_.along[i] - path_.along[i - 1]);
    const double distance = (path_.points[i - 1] + share * edge - position).squaredNorm();
    if (along >= progress_ && along <= window_end && distance < best_distance) {
      best = along;
      best_distance = distance;
    }
  }
  return best;
}

/// The distance ahead is halved until the robot sees the point.
bool PathFollower::look_from(const Point2& position, const ClearanceField& field, const Limits& limits) {
  progress_ = nearest(position, progress_ + projection_window_radii * radius_);
  double ahead = std::max(limits.max_speed * look_ahead_seconds, least_look_ahead_radii * radius_);
  for (int i = 0; i <= halvings + 1; ++i, ahead /= 2) {
    if (i > halvings) ahead = 0;
    if (!way_free(field, position, path_.at(progress_ + ahead), radius_)) continue;
    seen_ = progress_ + ahead;
    return true;
  }
  return false;
}

Point2 PathFollower::preferred_velocity(const Point2& position, const Limits& limits, double period) const {
  const Point2 gap = path_.at(seen_) - position;
  const double distance = gap.norm();
  if (distance < 1e-9) return Point2::Zero();
  const double remaining = distance + std::max(0.0, path_.length() - seen_);
  const double speed =
      std::min({limits.max_speed, speed_to_stop_within(remaining, limits, period), remaining / period});
  return gap * (speed / distance);
}

}  // namespace coppice
