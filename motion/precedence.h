// Decides when a robot may continue along its part of a joint plan (joint_plan.h), so that many robots move
// at once.
//
// Where a robot's way comes near a way of another robot that the plan moves earlier, the plan's order is
// kept: a gate on the robot's way stays closed until the other robot has come far enough along its own way.
// All gates refer to earlier moves, so the robot with the earliest unfinished move can always drive: there is
// no cycle of waits, however late a robot is (the temporal plan graph of Hönig et al., "Multi-Agent Path
// Finding with Kinematic Constraints", 2016, on continuous paths; order instead of times as in Čáp, Gregoire,
// Frazzoli, "Provably Safe and Deadlock-Free Execution of Multi-Robot Plans under Delaying Disturbances",
// 2016).
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "motion/joint_plan.h"

namespace coppice {

/// The way of a robot: its moves one after the other, in legs that end where it turns by a right angle or
/// more. Empty if the robot has no moves.
std::vector<Path> legs_of(std::size_t robot, std::span<const Move> moves);

struct Gate {
  double at = 0;          ///< metres along the own way; the robot must not pass this point
  std::size_t robot = 0;  ///< before this other robot
  double needed = 0;      ///< has come so many metres along its own way
};

/// The gates on a way, first to last, and which of them the robot has passed.
class Gates {
 public:
  Gates() = default;
  explicit Gates(std::vector<Gate> gates) : gates_(std::move(gates)) {}

  struct Wait {
    std::size_t robot = 0;
    double metres = 0;  ///< that the other robot still has to come
  };
  /// Metres along the way up to which it is open. `passed(robot)`: metres that another robot has come along
  /// its own way. `slack`: metres that it need not come. Gates behind `progress` (metres) do not count.
  template <class Passed>
  double open(double progress, double slack, Passed&& passed) {
    for (; next_ < gates_.size(); ++next_) {
      if (gates_[next_].at < progress - slack) continue;
      wait_ = {gates_[next_].robot, gates_[next_].needed - passed(gates_[next_].robot)};
      if (wait_.metres > slack) return gates_[next_].at;
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
  std::span<const Gate> all() const { return gates_; }
  /// From the first one that is closed.
  std::span<const Gate> left() const { return std::span(gates_).subspan(next_); }
  /// At the gate that is closed.
  const Wait& wait() const { return wait_; }
  bool all_open() const { return next_ == gates_.size(); }

 private:
  std::vector<Gate> gates_{};
  std::size_t next_ = 0;
  Wait wait_{};
};

/// Radii by which a robot may stray from its way.
inline constexpr double stray_radii = 0.04;

/// Radii that another robot need not come before it counts as having passed.
inline constexpr double gate_slack_radii = 0.01;

/// Number of pieces into which the ways are cut in order to see where they come near each other.
double pieces_of(std::span<const Move> moves, std::span<const double> radii);

/// The gates on the way of `robot`, first to last. Two ways count as near where discs that stray could touch.
/// If the computation reaches its limits, the robot waits for all earlier moves from there on: 10 million
/// pieces take at most 0.5 s and 80 MB.
std::vector<Gate> gates_of(std::size_t robot, std::span<const Move> moves, std::span<const double> radii);

}  // namespace coppice
