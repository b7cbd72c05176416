#include "robot_agent/agreement/reservation_pair.h"

#include <algorithm>

#include "motion/trajectory/space_time.h"
#include "robot_agent/agreement/priority.h"

namespace coppice {

namespace {

/// Null: the trajectory was planned without the other one.
const ReservationBasis* named_in(const ReservationMessage& of, const RenewedReservation& other) {
  const auto named = std::ranges::find_if(of.basis, [&](const ReservationBasis& b) {
    return b.robot == other.message.robot && b.number >= other.since;
  });
  return named != of.basis.end() ? &*named : nullptr;
}

Box<2> box_of(const Trajectory& trajectory) {
  Box<2> box{trajectory.front().position, trajectory.front().position};
  for (const TimedPoint& p : trajectory) box = extended(box, p.position);
  return box;
}

}  // namespace

bool is_of_plan(const ReservationMessage& r) {
  return !r.plan.leader.empty();
}
bool are_of_one_plan(const ReservationMessage& a, const ReservationMessage& b) {
  return is_of_plan(a) && a.plan.leader == b.plan.leader && a.plan.epoch == b.plan.epoch;
}

bool overrides(const ReservationMessage& other, const ReservationMessage& own) {
  if (is_of_plan(other) != is_of_plan(own)) return is_of_plan(other);
  if (is_of_plan(own) && other.plan.epoch != own.plan.epoch)
    return is_later_epoch(other.plan.epoch, own.plan.epoch);
  return plans_first(other.priority, other.way, other.robot, own.priority, own.way, own.robot);
}

bool come_near(const ReservationMessage& a, const ReservationMessage& b) {
  return distance(box_of(a.trajectory), box_of(b.trajectory)) < kept_apart(a.radius, b.radius);
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
