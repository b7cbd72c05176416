// States of a robot with a radius of 5 m that drives at up to 20 m/s.
#pragma once

#include "messages/messages.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

inline constexpr double period = control_period;

/// The robot keeps its velocity for a control period and then brakes.
inline RobotState state_of(const RobotName& robot, double stamp, const Point2& position,
                           const Point2& velocity = Point2::Zero()) {
  return {.robot = robot,
          .promise = {stamp, position, velocity, stamp + period, velocity, stamp + 2 * period},
          .radius = 5,
          .max_speed = 20,
          .max_acceleration = 40,
          .round = {}};
}

}  // namespace coppice
