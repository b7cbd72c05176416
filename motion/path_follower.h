// The preferred velocity of a robot on its path: straight towards the furthest point of the path, within
// reach, that it sees.
//
// Metres in the map frame, seconds, metres per second.
#pragma once

#include <optional>
#include <utility>

#include "motion/kinematics.h"
#include "motion/polyline.h"
#include "planning/clearance_field.h"
#include "planning/geometry.h"

namespace coppice {

class PathFollower {
 public:
  /// `path` holds at least one point; it keeps `radius` clear.
  PathFollower(Path path, double radius) : path_(std::move(path)), radius_(radius) {}

  /// Towards the path and along it; slows down so as to stand at its end. Zero where the robot sees no point
  /// of the path from where it is: then `lost()` holds, and a new path is needed.
  Point2 preferred_velocity(const Point2& position, const ClearanceField& field, const Limits& limits,
                            double period);

  bool lost() const { return lost_; }
  /// The path from the point on that the robot last headed for, or saw nearest to it.
  Path rest() const;
  /// What is left to drive from a place near the path, metres.
  double remaining(const Point2& position) const {
    return (path_.at(progress_) - position).norm() + path_.length() - progress_;
  }
  /// The same from any position, also where others have led the robot away from its path.
  double way_left(const Point2& position) const;
  double progress() const { return progress_; }  ///< how far along the path the robot has come, metres
  const Path& path() const { return path_.points; }

 private:
  Point2 keeping_right(const Point2& position, const Point2& target, double along,
                       const ClearanceField& field) const;
  std::optional<Point2> furthest_in_sight(const Point2& position, const ClearanceField& field, double ahead);
  double nearest(const Point2& position, double window_end) const;

  Polyline path_;
  double radius_;
  double progress_ = 0;  ///< how far along the path the robot has come
  double seen_ = 0;      ///< the same, of the point that the robot last saw
  bool lost_ = false;
};

}  // namespace coppice
