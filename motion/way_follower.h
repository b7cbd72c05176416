// Drives along a way exactly, up to the first gate that is closed (precedence.h).
//
// Unlike on a path of its own (path_follower.h), a robot that others rely on to be where a plan says strays
// no further than a small share of its radius: it slows down before corners and heads for a point close
// ahead.
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
  /// At least one leg; each begins where the one before ends, and is driven to its very end.
  WayFollower(std::span<const Path> legs, std::vector<Gate> gates, double radius);

  /// `passed(robot)`: how far along its own way another robot has come, metres.
  Point2 preferred_velocity(const Point2& position, const Limits& limits, double period,
                            const std::function<double(std::size_t)>& passed);
  /// Whether the last preferred velocity leads past what stands: if not, it heads for a nearer point.
  void led_past(bool everything);

  /// How far along the way the robot has come; its whole length once it is there.
  double progress() const { return progress_; }
  bool finished() const;
  struct Wait {
    std::size_t robot;
    double metres;  ///< that it has still to come
  };
  /// The gate that the last preferred velocity stopped before; none if the way ahead is open.
  const std::optional<Wait>& waits_for() const { return waits_for_; }

 private:
  void advance_progress(const Point2& position);
  double corner_speed(std::size_t corner, const Limits& limits, double period) const;
  double speed_limit(double stop, const Limits& limits, double period) const;

  Polyline way_;
  std::vector<double> leg_ends_;  ///< distance of the ends of the legs from the way's beginning
  std::size_t leg_ = 0;
  std::vector<Gate> gates_;
  std::size_t next_gate_ = 0;
  double radius_;
  double progress_ = 0;
  double look_ahead_;
  std::optional<Wait> waits_for_;
};

}  // namespace coppice
