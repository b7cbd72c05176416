#include "monitor/recording/gate_ahead.h"

#include <algorithm>
#include <vector>

#include "messages/reservation_relation.h"
#include "motion/trajectory/polyline.h"
#include "motion/trajectory/reserved_order.h"

namespace coppice {

namespace {

/// The number of the reservation that the robot carries out is that of the message.
bool is_carried_out(const SaidReservation* said, const RobotState& robot) {
  return said != nullptr && said->has_trajectory() && robot.reservation >= said->message.first_number &&
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
  const double offset = offset_between(own->message, first->message, 0);
  const std::vector<Gate> gates = order_of(own->message.trajectory, robot.radius, first->message.trajectory,
                                           first->message.radius, offset)
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
