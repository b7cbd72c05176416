// Decides when a robot may continue along its way, so that robots keep the order in which they are to pass.
//
// Where a robot's way comes near the way of another robot that is to go first, a gate on the robot's way
// stays closed until the other one has come far enough along its own way (the temporal plan graph of Hönig et
// al., "Multi-Agent Path Finding with Kinematic Constraints", 2016, on continuous paths; order instead of
// times as in Čáp, Gregoire, Frazzoli, "Provably Safe and Deadlock-Free Execution of Multi-Robot Plans under
// Delaying Disturbances", 2016). reserved_order.h finds the gates.
//
// Metres in the map frame.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "coppice/planning/geometry.h"

namespace coppice {

/// A way in legs that end where it turns by a right angle or more. Empty if it has fewer than two points.
std::vector<Path> legs_of(const Path& way);

struct Gate {
  double at = 0;      ///< metres along the own way; the robot must not pass this point
  double needed = 0;  ///< before the other robot has come so many metres along its own way
};

/// The gates on a way before one other robot, first to last, and which of them the robot has passed.
class Gates {
 public:
  Gates() = default;
  explicit Gates(std::vector<Gate> gates) : gates_(std::move(gates)) {}

  /// Metres along the way up to which it is open, if the other robot has come so many metres along its own
  /// way, and will come no less far. `slack`: metres that it need not come. Gates behind `progress` (metres)
  /// do not count.
  double open(double progress, double slack, double passed) {
    for (; next_ < gates_.size(); ++next_) {
      const Gate& gate = gates_[next_];
      if (gate.at >= progress - slack && gate.needed - passed > slack) return gate.at;
    }
    return std::numeric_limits<double>::infinity();
  }
  /// The same, if the other robot had come so many metres.
  double open_if(double progress, double slack, double passed) const {
    for (std::size_t k = next_; k < gates_.size(); ++k) {
      if (gates_[k].at >= progress - slack && gates_[k].needed - passed > slack) return gates_[k].at;
    }
    return std::numeric_limits<double>::infinity();
  }
  /// Metres that the other robot still has to come until the gate at `at` opens.
  double metres_until(double at, double passed) const {
    const auto gate = std::ranges::find(gates_, at, &Gate::at);
    return gate == gates_.end() ? 0 : std::max(0.0, gate->needed - passed);
  }
  std::span<const Gate> all() const { return gates_; }
  /// From the first one that is closed.
  std::span<const Gate> left() const { return std::span(gates_).subspan(next_); }
  bool all_open() const { return next_ == gates_.size(); }

 private:
  std::vector<Gate> gates_{};
  std::size_t next_ = 0;
};

/// Radii that another robot need not come before it counts as having passed.
inline constexpr double gate_slack_radii = 0.01;

}  // namespace coppice
