// The order in which two robots with trajectories pass where their ways come near each other: the robot whose
// trajectory passes first goes first, however late it is. The other one waits at a gate (precedence.h; Čáp,
// Gregoire, Frazzoli, "Provably Safe and Deadlock-Free Execution of Multi-Robot Plans under Delaying
// Disturbances", 2016).
//
// All gates lead from an earlier to a later time. So there is no cycle of waits.
//
// Metres in the map frame, seconds.
#pragma once

#include <vector>

#include "coppice/motion/trajectory.h"
#include "motion/precedence.h"
#include "motion/space_time.h"

namespace coppice {

struct Order {
  std::vector<Gate> gates{};  ///< on the own way, before the other robot
  /// Metres along the own way beyond which the trajectories keep apart: if both robots heed their gates they
  /// cannot touch there. Below 0: everywhere. Robots that were closer than kept_apart() when they began do
  /// not keep apart at first, and those that planned without knowing of each other may never do.
  double apart_beyond = -1;
};

/// The order of a robot and another one, as the first one must heed it. `offset`: seconds, to be added to the
/// other's times.
Order order_of(const Trajectory& own, double own_radius, const Trajectory& other, double other_radius,
               double offset);

}  // namespace coppice
