#include "monitor/recording/gate_ahead.h"

#include <algorithm>
#include <vector>

#include "motion/trajectory/polyline.h"
#include "motion/trajectory/reserved_order.h"

namespace coppice {

namespace {

bool are_of_one_plan(const ReservationMessage& a, const ReservationMessage& b) {
  return !a.plan.leader.empty() && a.plan.leader == b.plan.leader && a.plan.epoch == b.plan.epoch;
}

/// Seconds to be added to the other's times, if the reservation was planned around the other one.
std::optional<double> named_offset(const SaidReservation& of, const SaidReservation& other) {
  for (const ReservationBasis& b : of.message.basis) {
    if (b.robot == other.message.robot && b.number >= other.since) return b.offset;
  }
  return std::nullopt;
}

/// Seconds to be added to the other's times; 0 if none of the two tells.
double offset_between(const SaidReservation& own, const SaidReservation& other) {
  if (are_of_one_plan(own.message, other.message)) return own.message.plan.shift - other.message.plan.shift;
  if (const auto offset = named_offset(own, other)) return *offset;
  return -named_offset(other, own).value_or(0);
}

/// The number of the reservation that the robot carries out is that of the message.
bool is_carried_out(const SaidReservation* said, const RobotState& robot) {
  return said != nullptr && said->has_trajectory() && robot.reservation >= said->since &&
         robot.reservation <= said->message.number;
}

}  // namespace

std::optional<GateAhead> gate_ahead(const FleetMoment& moment, const RobotState& robot,
                                    const RobotName& goes_first) {
  const SeenRobot* const other = moment.robot(goes_first);
  const SaidReservation* const own = moment.reservation(robot.robot);
  const SaidReservation* const first = moment.reservation(goes_first);
  if (other == nullptr || !other->state || !is_carried_out(own, robot) || first == nullptr)
    return std::nullopt;
  if (!first->has_trajectory()) return std::nullopt;
  const double passed = is_carried_out(first, *other->state) ? other->state->reservation_progress : 0;
  const std::vector<Gate> gates = order_of(own->message.trajectory, robot.radius, first->message.trajectory,
                                           first->message.radius, offset_between(*own, *first))
                                      .gates;
  const double slack = gate_slack_radii * robot.radius;
  const auto closed = std::ranges::find_if(gates, [&](const Gate& gate) {
    return gate.at >= robot.reservation_progress - slack && gate.needed - passed > slack;
  });
  if (closed == gates.end()) return std::nullopt;
  const Polyline way(path_of(first->message.trajectory));
  return GateAhead{std::max(0.0, closed->at - robot.reservation_progress), closed->needed - passed,
                   way.at(closed->needed),
                   are_of_one_plan(own->message, first->message) ? own->message.plan.leader : RobotName()};
}

}  // namespace coppice
