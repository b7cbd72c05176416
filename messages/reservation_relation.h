// How the reservations of two robots belong together: whether they were planned around each other, and how
// the times of one count for the other. All who have the two messages find the same.
//
// Seconds of fleet time.
#pragma once

#include "messages/messages.h"

namespace coppice {

bool is_of_plan(const ReservationMessage& r);
bool are_of_one_plan(const ReservationMessage& a, const ReservationMessage& b);

/// They were planned around each other, or one of them around the other.
bool are_related(const ReservationMessage& a, const ReservationMessage& b);

/// Seconds to be added to the times of `other`, so that all robots order the two alike. `estimate`: the
/// difference of the clocks, where neither reservation tells it.
double offset_between(const ReservationMessage& own, const ReservationMessage& other, double estimate);

}  // namespace coppice
