// What a recording says of a fleet up to one moment: the view of the fleet (monitor/view/fleet_view.h), and
// what its robots have agreed on and heard.
//
// A state machine: messages go in, in the order of time. Units as in messages/messages.h.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "messages/bus.h"
#include "monitor/view/fleet_view.h"

namespace coppice {

/// The last reservation message of a robot.
struct SaidReservation {
  ReservationMessage message;
  bool is_given_up = false;  ///< it has no trajectory, and the one before it had one
  bool has_trajectory() const { return !message.trajectory.empty(); }
  /// The robot waits for its turn to reserve.
  bool is_wish() const { return message.trajectory.empty() && message.way > 0; }
};

class FleetMoment {
 public:
  /// `listener`: the robot whose hearing is kept; empty: nobody's.
  explicit FleetMoment(RobotName listener = {}) : listener_(std::move(listener)) {}

  void on(const Arrival& arrival);

  const FleetView& view() const { return view_; }
  /// Seconds by the clock of the recording's first run; nothing before the first mission. `fleet`: fleet time
  /// of the present run.
  std::optional<double> time_of(double fleet) const;
  std::optional<double> time_at(WallTime at) const;
  /// Null: nothing was heard of it in this run.
  const SeenRobot* robot(const RobotName& name) const;
  const SaidReservation* reservation(const RobotName& name) const;
  /// The newest joint plan of a leader; null: none.
  const JointPlanMessage* plan_of(const RobotName& leader) const;
  /// Whether a joint plan says that it does not bring the robot to its goal. It is that of the robot's round.
  bool is_stranded(const RobotState& robot) const;
  /// As time_of: since when others count the robot as failed; none: they do not.
  std::optional<double> failed_since(const RobotName& name) const;
  /// The order by which an operator halted the robot; null: not known.
  const OrderMessage* halt_of(const RobotName& name) const;
  /// The order that the robot's current mission serves; null: none.
  const OrderMessage* order_of(const SeenRobot& robot) const;

  /// The last state of each robot of which the listener has told that it heard it.
  const std::map<RobotName, Echo>& heard() const { return heard_; }
  /// The last reservation of each robot that the listener has told to heed.
  const std::map<RobotName, std::uint32_t>& heeded() const { return heeded_; }

 private:
  void receive(const RobotState& state, WallTime at);
  void receive(const ReservationMessage& reservation, WallTime at);
  void receive(const JointPlanMessage& plan, WallTime) { plans_[plan.round.leader] = plan; }
  void receive(const OrderStatus& status, WallTime) { orders_[status.order.id] = status; }
  void receive(const Mission& mission, WallTime);
  void begin_anew();

  RobotName listener_;
  FleetView view_;
  std::uint32_t run_ = 0;
  std::optional<FleetClock> first_{};    ///< of the first run
  std::optional<FleetClock> present_{};  ///< of the present run
  std::map<RobotName, SaidReservation> reservations_;
  std::map<RobotName, JointPlanMessage> plans_;
  std::map<RobotName, double> failed_;
  std::map<std::string, OrderStatus> orders_;
  std::map<RobotName, Echo> heard_;
  std::map<RobotName, std::uint32_t> heeded_;
};

}  // namespace coppice
