// The order in which two robots with trajectories pass where their ways come near each other: the robot whose
// trajectory passes first goes first, however late it is. The other one waits at a gate (precedence.h; Čáp,
// Gregoire, Frazzoli, "Provably Safe and Deadlock-Free Execution of Multi-Robot Plans under Delaying
// Disturbances", 2016).
//
// All gates lead from an earlier to a later time. So there is no cycle of waits.
//
// Metres in the map frame, seconds.
#pragma once

#include <span>
#include <vector>

#include "coppice/motion/trajectory.h"
#include "motion/trajectory/precedence.h"
#include "motion/trajectory/space_time.h"

namespace coppice {

/// A part of a way, metres along it.
struct Stretch {
  double begin = 0;
  double end = 0;
};

struct Order {
  std::vector<Gate> gates{};  ///< on the own way, before the other robot
  /// The parts of the own way, first to last, where the two trajectories do not keep apart. Elsewhere the
  /// robots cannot touch if both heed their gates. Robots that are closer than kept_apart() where they begin
  /// do not keep apart at first, and those whose goals are so close not in the end. Robots that planned
  /// without knowing of each other may not keep apart anywhere.
  std::vector<Stretch> too_close{};
  /// The parts of the other way where that robot is meanwhile.
  std::vector<Stretch> other_too_close{};
};

/// Metres along a way beyond all of these parts. Below 0: there are none.
double beyond(std::span<const Stretch> parts);

/// The order of a robot and another one, as the first one must heed it. `offset`: seconds, to be added to the
/// other's times.
Order order_of(const Trajectory& own, double own_radius, const Trajectory& other, double other_radius,
               double offset);

}  // namespace coppice
