// Converts what messages say into the types of motion/.
#pragma once

#include "coppice/motion/kinematics.h"
#include "messages/messages.h"

namespace coppice {

inline Limits limits_of(const RobotState& state) {
  return {state.max_speed, state.max_acceleration, state.max_angular_speed, state.max_angular_acceleration};
}

/// Metres from its goal at which a robot has arrived. Half of the mission's tolerance: so an observer that
/// knows the position less exactly agrees.
inline double arrives_within(const Mission& mission) {
  return mission.goal_tolerance / 2;
}

}  // namespace coppice
