#include "monitor/view/robot_progress.h"

#include <algorithm>
#include <limits>

namespace coppice {

namespace {

// A point this many metres further along the path must be one metre nearer to the robot to be preferred.
constexpr double metres_along_for_one_aside = 10;
// Radii. A robot that is pushed back and forth by less makes no progress.
constexpr double least_step = 0.1;

struct Nearest {
  double along = 0;     ///< to that point
  double distance = 0;  ///< to it
};

/// The robot's point on the path. `before`: its last point.
Nearest nearest(const Polyline& path, const Point2& position, std::optional<double> before) {
  Nearest best{0, (path.points.front() - position).norm()};
  double least_cost = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const Point2& from = path.points[i == 0 ? 0 : i - 1];
    const Point2 edge = path.points[i] - from;
    const double squared = edge.squaredNorm();
    const double share = squared > 0 ? std::clamp((position - from).dot(edge) / squared, 0.0, 1.0) : 1;
    const double along = path.along[i == 0 ? 0 : i - 1] + share * edge.norm();
    const double distance = (from + share * edge - position).norm();
    const double cost = distance + (before ? std::abs(along - *before) / metres_along_for_one_aside : 0);
    if (cost >= least_cost) continue;
    least_cost = cost;
    best = {along, distance};
  }
  return best;
}

bool waits(const RobotState& state) {
  return !state.waits_for.empty() || state.stage == Stage::waiting;
}

bool has_somewhere_to_go(Phase phase) {
  return phase == Phase::planning || phase == Phase::driving || has_no_way(phase);
}

}  // namespace

void RobotProgress::begin_mission() {
  nearer_at_.reset();
  least_.reset();
}

void RobotProgress::follow(const Path& path) {
  path_.reset();
  if (!path.empty()) path_.emplace(path);
  along_.reset();
  least_.reset();
}

void RobotProgress::on(const RobotState& state) {
  note_wait(state);
  if (!has_somewhere_to_go(state.phase)) {
    nearer_at_.reset();
    least_.reset();
  } else if (!nearer_at_) {
    nearer_at_ = state.promise.stamp;
  }
  if (!path_) return;
  const Nearest place = nearest(*path_, state.promise.position, along_);
  along_ = place.along;
  const double left = place.distance + path_->length() - place.along;
  if (!least_) least_ = left;
  if (left > *least_ - least_step * state.radius) return;
  least_ = left;
  if (nearer_at_) nearer_at_ = state.promise.stamp;
}

void RobotProgress::note_wait(const RobotState& state) {
  if (waits(state) && has_somewhere_to_go(state.phase)) {
    if (!waits_since_) waits_since_ = state.promise.stamp;
  } else if (waits_since_) {
    waited_ += std::max(0.0, state.promise.stamp - *waits_since_);
    waits_since_.reset();
  }
}

std::optional<double> RobotProgress::way_left(const Point2& position) const {
  if (!path_) return std::nullopt;
  const Nearest place = nearest(*path_, position, along_);
  return place.distance + path_->length() - place.along;
}

double RobotProgress::waiting(double time) const {
  return waits_since_ ? std::max(0.0, time - *waits_since_) : 0;
}

double RobotProgress::without_progress(double time) const {
  return nearer_at_ ? std::max(0.0, time - *nearer_at_) : 0;
}

}  // namespace coppice
