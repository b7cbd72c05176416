#include "messages/reservation_relation.h"

#include <algorithm>

namespace coppice {

namespace {

/// Null: the trajectory was planned without the other one.
const ReservationBasis* named_in(const ReservationMessage& of, const ReservationMessage& other) {
  const auto named = std::ranges::find_if(of.basis, [&](const ReservationBasis& b) {
    return b.robot == other.robot && b.number >= other.first_number;
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

bool are_related(const ReservationMessage& a, const ReservationMessage& b) {
  return are_of_one_plan(a, b) || named_in(a, b) != nullptr || named_in(b, a) != nullptr;
}

double offset_between(const ReservationMessage& own, const ReservationMessage& other, double estimate) {
  if (are_of_one_plan(own, other)) return own.plan.shift - other.plan.shift;
  if (const auto* const named = named_in(own, other)) return named->offset;
  if (const auto* const named = named_in(other, own)) return -named->offset;
  return estimate;
}

}  // namespace coppice
