// The preferred velocity of a robot on its path: straight towards the furthest point of the path, within
// reach, that it sees.
//
// Metres in the map frame, seconds, metres per second.
#pragma once

#include "motion/kinematics.h"
#include "planning/clearance_field.h"
#include "planning/geometry.h"

namespace coppice {

class PathFollower {
 public:
  /// `path` holds at least one point; it keeps `radius` clear.
  PathFollower(Path path, double radius);

  /// Towards the path and along it; slows down so as to stand at its end. Zero where the robot sees no point
  /// of the path from where it is: then `lost()` holds, and a new path is needed.
  Point2 preferred_velocity(const Point2& position, const ClearanceField& field, const Limits& limits,
                            double period);

  bool lost() const { return lost_; }
  /// The path from the point on that the robot last headed for, or saw nearest to it.
  Path rest() const;
  /// What is left to drive from a place near the path, metres.
  double remaining(const Point2& position) const {
    return (point_at(progress_) - position).norm() + along_.back() - progress_;
  }
  double progress() const { return progress_; }  ///< how far along the path the robot has come, metres
  const Path& path() const { return path_; }

 private:
  Point2 keeping_right(const Point2& position, const Point2& target, double along,
                       const ClearanceField& field) const;
  Point2 point_at(double along) const;
  double advance_progress(const Point2& position);

  Path path_;
  std::vector<double> along_;  ///< distance of each waypoint from the path's beginning
  double radius_;
  double progress_ = 0;  ///< how far along the path the robot has come
  double seen_ = 0;      ///< the same, of the point that the robot last saw
  bool lost_ = false;
};

}  // namespace coppice
