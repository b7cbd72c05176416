// Drives along a way exactly, up to the first closed gate (precedence.h).
//
// Other robots rely on this robot to be where the plan says. So, unlike on a path of its own
// (path_follower.h), it strays by no more than a small share of its radius: it slows down before corners and
// heads for a point close ahead.
//
// Metres in the map frame, seconds, metres per second.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "motion/kinematics.h"
#include "motion/polyline.h"
#include "motion/precedence.h"

namespace coppice {

class WayFollower {
 public:
  /// At least one leg. Each must begin where the previous one ends; the robot drives to the very end of each.
  WayFollower(std::span<const Path> legs, std::vector<Gate> gates, double radius);

  /// `passed(robot)`: metres that another robot has come along its own way.
  Point2 preferred_velocity(const Point2& position, const Limits& limits, double period,
                            const std::function<double(std::size_t)>& passed);
  /// Tells whether the last preferred velocity was safe with respect to all that stands. If not, the robot
  /// heads for a nearer point.
  void led_past(bool everything);

  /// Metres along the way that the robot has come; the whole length once it has finished.
  double progress() const { return progress_; }
  bool finished() const;
  struct Wait {
    std::size_t robot;
    double metres;  ///< that the other robot still has to come
  };
  /// The gate at which the last preferred velocity stopped; none if the way ahead is open.
  const std::optional<Wait>& waits_for() const { return waits_for_; }

 private:
  void advance_progress(const Point2& position);
  double corner_speed(std::size_t corner, const Limits& limits, double period) const;
  double speed_limit(double stop, const Limits& limits, double period) const;

  Polyline way_;
  std::vector<double> leg_ends_;  ///< distance of the legs' ends from the way's beginning, metres
  std::size_t leg_ = 0;
  std::vector<Gate> gates_;
  std::size_t next_gate_ = 0;
  double radius_;
  double progress_ = 0;
  double look_ahead_;
  std::optional<Wait> waits_for_;
};

}  // namespace coppice
