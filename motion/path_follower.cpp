#include "motion/path_follower.h"

#include <algorithm>
#include <array>
#include <utility>

#include "motion/free_way.h"

namespace coppice {

namespace {

// How far ahead of the robot the point that it heads for may lie: far enough to cut corners smoothly, near
// enough that a robot pushed aside comes back to its path. In seconds at full speed, and at least in radii.
constexpr double look_ahead_seconds = 1.5;
constexpr double least_look_ahead_radii = 2;
// The projection onto the path is searched this far ahead of the last one, in radii: a path that comes back
// past itself is not taken for its later part.
constexpr double projection_window_radii = 8;
constexpr int halvings = 6;
// How far to the right of its path a robot keeps where there is room: with a little more than its radius, two
// that meet pass each other.
constexpr double lane_radii = 1.15;
constexpr std::array lane_shares{1.0, 0.75, 0.5, 0.25};

}  // namespace

PathFollower::PathFollower(Path path, double radius) : path_(std::move(path)), radius_(radius) {
  along_.push_back(0);
  for (std::size_t i = 1; i < path_.size(); ++i) {
    along_.push_back(along_.back() + (path_[i] - path_[i - 1]).norm());
  }
}

Point2 PathFollower::point_at(double along) const {
  const auto next = std::upper_bound(along_.begin(), along_.end(), along);
  if (next == along_.end()) return path_.back();
  if (next == along_.begin()) return path_.front();
  const auto i = static_cast<std::size_t>(next - along_.begin());
  const double share = (along - along_[i - 1]) / (along_[i] - along_[i - 1]);
  return path_[i - 1] + share * (path_[i] - path_[i - 1]);
}

Path PathFollower::rest() const {
  Path rest{point_at(seen_)};
  for (std::size_t i = 0; i < path_.size(); ++i) {
    if (along_[i] > seen_) rest.push_back(path_[i]);
  }
  return rest;
}

/// The nearest point of the path within the window, as a distance along it.
double PathFollower::advance_progress(const Point2& position) {
  const double window_end = progress_ + projection_window_radii * radius_;
  double best = progress_;
  double best_distance = (point_at(progress_) - position).squaredNorm();
  for (std::size_t i = 1; i < path_.size(); ++i) {
    if (along_[i] < progress_ || along_[i - 1] > window_end) continue;
    const Point2 edge = path_[i] - path_[i - 1];
    const double squared = edge.squaredNorm();
    if (squared == 0) continue;
    const double share = std::clamp((position - path_[i - 1]).dot(edge) / squared, 0.0, 1.0);
    const double along = along_[i - 1] + share * (along_[i] - along_[i - 1]);
    const double distance = (path_[i - 1] + share * edge - position).squaredNorm();
    if (along >= progress_ && along <= window_end && distance < best_distance) {
      best = along;
      best_distance = distance;
    }
  }
  return best;
}

/// The target, moved off the path to the right as far as is free: whoever comes along the same path the other
/// way does so too, and they pass. The nearer the goal, the less.
Point2 PathFollower::keeping_right(const Point2& position, const Point2& target, double along,
                                   const ClearanceField& field) const {
  const Point2 way = target - point_at(progress_);
  const double remaining = along_.back() - along;
  const double most = std::min(lane_radii * radius_, remaining / 4);
  if (way.norm() < 1e-9 || most <= 0) return target;
  const Point2 right = Point2(way.y(), -way.x()) / way.norm();
  for (const double share : lane_shares) {
    Point2 shifted = target + share * most * right;
    if (way_free(field, position, shifted, radius_) && way_free(field, target, shifted, radius_))
      return shifted;
  }
  return target;
}

Point2 PathFollower::preferred_velocity(const Point2& position, const ClearanceField& field,
                                        const Limits& limits, double period) {
  progress_ = advance_progress(position);
  const double total = along_.back();
  double ahead = std::max(limits.max_speed * look_ahead_seconds, least_look_ahead_radii * radius_);
  Point2 target = point_at(progress_ + ahead);
  lost_ = !way_free(field, position, target, radius_);
  for (int i = 0; i < halvings && lost_; ++i) {
    ahead /= 2;
    target = point_at(progress_ + ahead);
    lost_ = !way_free(field, position, target, radius_);
  }
  if (lost_) {
    ahead = 0;
    target = point_at(progress_);
    lost_ = !way_free(field, position, target, radius_);
  }
  if (lost_) return Point2::Zero();
  seen_ = progress_ + ahead;

  target = keeping_right(position, target, progress_ + ahead, field);

  const Point2 gap = target - position;
  const double distance = gap.norm();
  if (distance < 1e-9) return Point2::Zero();
  const double remaining = distance + std::max(0.0, total - progress_ - ahead);
  const double speed =
      std::min({limits.max_speed, speed_to_stop_within(remaining, limits, period), remaining / period});
  return gap * (speed / distance);
}

}  // namespace coppice
