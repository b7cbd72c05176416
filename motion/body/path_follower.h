// A robot on its path: whether it sees the path, how far it has come, and its preferred velocity, which is
// straight towards the furthest visible point of the path within a look-ahead distance.
//
// Metres in the map frame, seconds, metres per second.
#pragma once

#include <utility>

#include "coppice/motion/kinematics.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "motion/trajectory/polyline.h"

namespace coppice {

class PathFollower {
 public:
  /// `path` must hold at least one point and keep `radius` (metres) clear of obstacles.
  PathFollower(Path path, double radius) : path_(std::move(path)), radius_(radius) {}

  /// Looks from a position for the furthest visible point of the path within the look-ahead distance. False:
  /// none is in sight, and a new path is needed.
  bool look_from(const Point2& position, const ClearanceField& field, const Limits& limits);
  /// The velocity from a position, from which the robot saw its path, towards the point that it saw, slowing
  /// down so as to stand at the end of the path.
  Point2 preferred_velocity(const Point2& position, const Limits& limits, double period) const;

  /// The path from the point that the robot last saw.
  Path rest() const;
  /// Metres left to drive from a position near the path.
  double remaining(const Point2& position) const {
    return (path_.at(progress_) - position).norm() + path_.length() - progress_;
  }
  /// The same from any position, also where others have led the robot away from its path.
  double way_left(const Point2& position) const;
  double progress() const { return progress_; }  ///< metres along the path that the robot has come
  const Path& path() const { return path_.points; }

 private:
  double nearest(const Point2& position, double window_end) const;

  Polyline path_;
  double radius_;
  double progress_ = 0;  ///< metres along the path that the robot has come
  double seen_ = 0;      ///< metres along the path to the point that the robot last saw
};

}  // namespace coppice
