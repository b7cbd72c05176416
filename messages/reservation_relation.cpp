#include "messages/reservation_relation.h"

#include <algorithm>

namespace coppice {

namespace {

/// Null: the trajectory was planned without the other one.
const ReservationBasis* named_in(const ReservationMessage& of, const RenewedReservation& other) {
  const auto named = std::ranges::find_if(of.basis, [&](const ReservationBasis& b) {
    return b.robot == other.message.robot && b.number >= other.since;
  });
  return named != of.basis.end() ? &*named : nullptr;
}

}  // namespace

bool is_of_plan(const ReservationMessage& r) {
  return !r.plan.leader.empty();
}
bool are_of_one_plan(const ReservationMessage& a, const ReservationMessage& b) {
  return is_of_plan(a) && a.plan.leader == b.plan.leader && a.plan.epoch == b.plan.epoch;
}

bool are_related(const RenewedReservation& a, const RenewedReservation& b) {
  return are_of_one_plan(a.message, b.message) || named_in(a.message, b) != nullptr ||
         named_in(b.message, a) != nullptr;
}

double offset_between(const RenewedReservation& own, const RenewedReservation& other, double estimate) {
  if (are_of_one_plan(own.message, other.message)) return own.message.plan.shift - other.message.plan.shift;
  if (const auto* const named = named_in(own.message, other)) return named->offset;
  if (const auto* const named = named_in(other.message, own)) return -named->offset;
  return estimate;
}

}  // namespace coppice
