#include "robot_agent/agreement/reservation_pair.h"

#include "motion/trajectory/space_time.h"
#include "robot_agent/agreement/priority.h"

namespace coppice {

namespace {

Box<2> box_of(const Trajectory& trajectory) {
  Box<2> box{trajectory.front().position, trajectory.front().position};
  for (const TimedPoint& p : trajectory) box = extended(box, p.position);
  return box;
}

}  // namespace

bool overrides(const ReservationMessage& other, const ReservationMessage& own) {
  if (is_of_plan(other) != is_of_plan(own)) return is_of_plan(other);
  if (is_of_plan(own) && other.plan.epoch != own.plan.epoch)
    return is_later_epoch(other.plan.epoch, own.plan.epoch);
  return plans_first(other.priority, other.way, other.robot, own.priority, own.way, own.robot);
}

bool come_near(const ReservationMessage& a, const ReservationMessage& b) {
  return distance(box_of(a.trajectory), box_of(b.trajectory)) < kept_apart(a.radius, b.radius);
}

}  // namespace coppice
