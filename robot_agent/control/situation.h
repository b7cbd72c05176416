// All that one decision of a robot depends on, at the beginning of a control period. Nobody changes it.
//
// Metres in the map frame; fleet time, seconds.
#pragma once

#include <optional>
#include <span>

#include "coppice/motion/coordination.h"
#include "coppice/planning/clearance_field.h"
#include "messages/messages.h"
#include "motion/body/braking_line.h"
#include "motion/body/driver.h"
#include "robot_agent/agreement/held_reservation.h"
#include "robot_agent/control/task.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

struct Situation {
  // The robot
  double now;
  const RobotName& robot;
  const Driver& body;  ///< at the beginning of the period
  const Task& task;
  const HeldReservation* held;  ///< null: it has no reservation. It has looked at its gates
  bool executes_plan;           ///< the reservation is its part of a joint plan
  bool leads_elsewhere;         ///< the reservation, and not to its goal
  bool waits_for_its_turn;      ///< to reserve
  Stage stage;                  ///< in a coordination round
  bool is_stranded;             ///< no joint plan brings it to its goal
  double last_moved;            ///< when it last came on
  std::optional<double> faces;  ///< the yaw to which it is to turn where it stands

  // Holds
  bool joins;
  bool is_behind;  ///< the robot that follows the body
  bool listens;
  bool may_leave_strip;
  bool may_set_off;  ///< it knows where all others are

  // The others, and the map
  const Fleet& fleet;
  std::span<const Neighbour> neighbours;  ///< all that may come near, but those that an order keeps apart
  const ClearanceField& field;
  Coordination coordination;
};

}  // namespace coppice
