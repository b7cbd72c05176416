// Drives along a way exactly, as far as it is open (precedence.h).
//
// Other robots rely on this robot to be where the plan says. So, unlike on a path of its own
// (path_follower.h), it strays by no more than a small share of its radius: it slows down before corners and
// heads for a point close ahead.
//
// Metres in the map frame, seconds, metres per second.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coppice/motion/kinematics.h"
#include "motion/trajectory/polyline.h"

namespace coppice {

class WayFollower {
 public:
  /// At least one leg. Each must begin where the previous one ends; the robot drives to the very end of each.
  /// `stray`: metres by which the robot may stray from its way.
  WayFollower(std::span<const Path> legs, double radius, double stray);

  /// To be called for each period, one after the other: where the robot is at the end of the period.
  void come_to(const Point2& position);
  /// `position`: the last one to which the robot came. `open`: metres along the way up to which the robot may
  /// drive.
  Point2 preferred_velocity(const Point2& position, const Limits& limits, double period, double open) const;
  /// Where the robot comes to along the way if it drives straight from a to b and has come `from` metres by
  /// then; none if it strays too far meanwhile.
  std::optional<double> along_strip(const Point2& a, const Point2& b, double from) const;
  /// Metres along the way, not behind the robot, to where it comes within `kept` of a point before it comes
  /// within `touching` of it; infinite if it does not within the next `ahead` metres.
  double stop_before(const Point2& point, double touching, double kept, double ahead) const;
  /// Tells whether the last preferred velocity was safe with respect to all that stands. If not, the robot
  /// heads for a nearer point.
  void led_past(bool everything);

  /// Metres along the way that the robot has come; the whole length once it has finished.
  double progress() const { return progress_; }
  bool finished() const;
  double length() const { return way_.length(); }
  /// Metres between a position and the way where the robot has come to.
  double off_the_way(const Point2& position) const { return (way_.at(progress_) - position).norm(); }

 private:
  double nearest(const Point2& position, double from) const;
  double window_end(const Point2& position, double from) const;
  bool in_strip(const Point2& a, const Point2& b, double from, int halvings) const;
  double look_ahead_in_strip(const Point2& position, double usual) const;
  /// The arc on which the robot drives around a corner, close to it.
  struct Arc {
    double radius = 0;   ///< metres; infinite where the way goes straight on
    double bend = 0;     ///< radians
    double tangent = 0;  ///< metres before the corner at which it begins, and after it at which it ends
  };
  Arc arc_at(std::size_t corner) const;
  Point2 rounded_at(double along) const;
  double speed_limit(double stop, const Limits& limits, double period) const;

  Polyline way_;
  std::vector<Arc> arcs_;         ///< by point of the way
  std::vector<double> leg_ends_;  ///< distance of the legs' ends from the way's beginning, metres
  std::size_t leg_ = 0;
  double radius_;
  double stray_;  ///< metres
  double progress_ = 0;
  double look_ahead_ = 1;  ///< share of the usual one
};

}  // namespace coppice
