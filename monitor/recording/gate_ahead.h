// The gate at which a robot waits for another one that goes first, reckoned from their reservations as the
// robots reckon it (motion/trajectory/reserved_order.h).
//
// Metres in the map frame.
#pragma once

#include <optional>

#include "monitor/recording/fleet_moment.h"

namespace coppice {

struct GateAhead {
  double ahead = 0;                  ///< from the robot to the gate, along its way
  double left = 0;                   ///< that the other robot still has to come until the gate opens
  Point2 opens_at = Point2::Zero();  ///< the place to which the other robot has to come
  RobotName leader{};                ///< of the joint plan that gives the order; empty: the reservations do
  bool operator==(const GateAhead&) const = default;
};

/// None: the recording does not tell.
std::optional<GateAhead> gate_ahead(const FleetMoment& moment, const RobotState& robot,
                                    const RobotName& goes_first);

}  // namespace coppice
