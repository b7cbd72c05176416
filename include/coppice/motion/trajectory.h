// A path with times: where a robot plans to be, and when.
//
// Metres in the map frame, seconds of fleet time.
#pragma once

#include <vector>

#include "coppice/planning/geometry.h"

namespace coppice {

struct TimedPoint {
  double time = 0;
  Point2 position = Point2::Zero();
  bool operator==(const TimedPoint&) const = default;
};

/// Straight at constant speed from each point to the next. The times grow. The robot stands at the first
/// point before, and at the last one ever after.
using Trajectory = std::vector<TimedPoint>;

inline Path path_of(const Trajectory& trajectory) {
  Path path;
  for (const TimedPoint& p : trajectory) {
    if (path.empty() || path.back() != p.position) path.push_back(p.position);
  }
  return path;
}

/// The same trajectory, so many seconds later.
inline Trajectory shifted(Trajectory trajectory, double seconds) {
  for (TimedPoint& p : trajectory) p.time += seconds;
  return trajectory;
}

/// The part of a trajectory from the point that is so many metres along its way. It begins when the robot
/// leaves that point.
Trajectory rest_of(const Trajectory& trajectory, double along);

/// Whether two robots that carry out their trajectories are ever closer than `near` metres between their
/// centres, from a time on.
bool come_too_close(const Trajectory& a, const Trajectory& b, double near, double from);

}  // namespace coppice
