// Which of two reservations holds that were planned without each other. All robots find the same.
//
// Metres in the map frame.
#pragma once

#include "messages/messages.h"
#include "messages/reservation_relation.h"

namespace coppice {

/// Whether another reservation holds against this one, if the two were planned without each other.
bool overrides(const ReservationMessage& other, const ReservationMessage& own);

/// Whether the two robots may come near each other, at whatever times. Both have trajectories.
bool come_near(const ReservationMessage& a, const ReservationMessage& b);

}  // namespace coppice
