// Whether a robot that drives by itself comes on. Fleet time, seconds; metres.
#pragma once

#include <algorithm>

#include "coppice/motion/kinematics.h"

namespace coppice {

/// Seconds without progress after which a robot is stalled.
inline constexpr double stall = 3;

/// Metres that count as progress: half a radius, or half of what the limits allow in `stall` seconds.
inline double least_gain(double radius, const Limits& limits) {
  constexpr double of_radius = 0.5;
  constexpr double of_limits = 0.5;
  const double speeds_up = std::min(stall, limits.max_speed / limits.max_acceleration);
  const double most =
      limits.max_acceleration * speeds_up * speeds_up / 2 + limits.max_speed * (stall - speeds_up);
  return std::min(of_radius * radius, of_limits * most);
}

class ProgressWatch {
 public:
  /// A new path begins: progress along it counts from 0.
  void begin_path() { gain_ = turned_ = 0; }
  /// The robot has a reason to stand.
  void pause_stall_clock(double now) { gain_time_ = now; }
  /// The robot turned on the spot for some seconds. That excuses it, for `most` seconds until it comes on.
  void turns(double seconds, double most, double now) {
    turned_ += seconds;
    if (turned_ <= most) pause_stall_clock(now);
  }
  /// The robot bound itself to stand.
  void is_bound(double now) { bound_time_ = now; }
  /// `progress`: metres along the path.
  void comes_to(double progress, double least, double now) {
    if (progress < gain_ + least) return;
    gain_ = progress;
    gain_time_ = now;
    turned_ = 0;
  }

  /// Seconds without progress in which the robot was not bound to stand.
  double stalled_for(double now) const { return now - std::max(gain_time_, bound_time_); }
  double without_progress_for(double now) const { return now - gain_time_; }

 private:
  double gain_ = 0;  ///< metres along the path at the last progress
  double gain_time_ = 0;
  double turned_ = 0;  ///< seconds since then
  double bound_time_ = 0;
};

}  // namespace coppice
