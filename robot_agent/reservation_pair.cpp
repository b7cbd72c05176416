#include "robot_agent/reservation_pair.h"

#include <algorithm>

#include "motion/space_time.h"
#include "robot_agent/turn.h"

namespace coppice {

namespace {

bool is_in_basis(const ReservationMessage& of, const RobotName& robot, std::uint32_t number) {
  return std::ranges::any_of(
      of.basis, [&](const ReservationBasis& b) { return b.robot == robot && b.number == number; });
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
  return plans_first(other.turn, other.way, other.robot, own.turn, own.way, own.robot);
}

bool come_near(const ReservationMessage& a, const ReservationMessage& b) {
  return distance(box_of(a.trajectory), box_of(b.trajectory)) < kept_apart(a.radius, b.radius);
}

bool are_related(const ReservationMessage& a, const ReservationMessage& b) {
  return are_of_one_plan(a, b) || is_in_basis(a, b.robot, b.number) || is_in_basis(b, a.robot, a.number);
}

double offset_between(const ReservationMessage& own, const ReservationMessage& other, double estimate) {
  if (are_of_one_plan(own, other)) return own.plan.shift - other.plan.shift;
  for (const ReservationBasis& b : own.basis) {
    if (b.robot == other.robot && b.number == other.number) return b.offset;
  }
  for (const ReservationBasis& b : other.basis) {
    if (b.robot == own.robot && b.number == own.number) return -b.offset;
  }
  return estimate;
}

}  // namespace coppice
