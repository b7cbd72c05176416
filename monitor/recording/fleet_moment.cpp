#include "monitor/recording/fleet_moment.h"

#include <algorithm>
#include <variant>

namespace coppice {

namespace {

template <class Map>
const typename Map::mapped_type* found_in(const Map& map, const typename Map::key_type& key) {
  const auto known = map.find(key);
  return known == map.end() ? nullptr : &known->second;
}

/// An operator's order that makes this robot stand.
bool halts(const OrderMessage& order, const RobotName& robot) {
  const bool is_halt = order.action == Action::pause || order.action == Action::stop;
  return is_halt && (order.robots.empty() || std::ranges::count(order.robots, robot) > 0);
}

}  // namespace

void FleetMoment::on(const Arrival& arrival) {
  view_.on(arrival.message, arrival.at);
  if (view_.run() != run_) begin_anew();
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m, arrival.at); }) receive(m, arrival.at);
      },
      *arrival.message);
}

void FleetMoment::begin_anew() {
  run_ = view_.run();
  present_.reset();
  reservations_.clear();
  plans_.clear();
  failed_.clear();
  heard_.clear();
  heeded_.clear();
}

void FleetMoment::receive(const Mission& mission, WallTime) {
  if (!present_) present_ = mission.clock;
  if (!first_) first_ = mission.clock;
}

std::optional<double> FleetMoment::time_of(double fleet) const {
  if (!first_ || !present_) return std::nullopt;
  return *present_ == *first_ ? fleet : first_->fleet_time(present_->wall_time(fleet));
}

std::optional<double> FleetMoment::time_at(WallTime at) const {
  const auto fleet = view_.fleet_time(at);
  return fleet ? time_of(*fleet) : std::nullopt;
}

const SeenRobot* FleetMoment::robot(const RobotName& name) const {
  const auto number = view_.find(name);
  return number ? &view_.robots()[*number] : nullptr;
}

const SaidReservation* FleetMoment::reservation(const RobotName& name) const {
  return found_in(reservations_, name);
}

const JointPlanMessage* FleetMoment::plan_of(const RobotName& leader) const {
  return found_in(plans_, leader);
}

bool FleetMoment::is_stranded(const RobotState& robot) const {
  const JointPlanMessage* const plan = plan_of(robot.round.leader);
  if (plan == nullptr || plan->round.epoch != robot.round.epoch) return false;
  const auto member = std::ranges::find(plan->members, robot.robot, &JointPlanMessage::Member::robot);
  return member != plan->members.end() && member->stranded;
}

std::optional<double> FleetMoment::failed_since(const RobotName& name) const {
  const double* const since = found_in(failed_, name);
  return since != nullptr ? std::optional(*since) : std::nullopt;
}

const OrderMessage* FleetMoment::halt_of(const RobotName& name) const {
  const OrderStatus* last = nullptr;
  for (const auto& [id, status] : orders_) {
    if (!halts(status.order, name) || is_refused(status)) continue;
    if (last == nullptr || status.accepted_at > last->accepted_at) last = &status;
  }
  return last != nullptr ? &last->order : nullptr;
}

const OrderMessage* FleetMoment::order_of(const SeenRobot& robot) const {
  if (!robot.mission) return nullptr;
  const auto serves = [&](const auto& known) {
    const OrderStatus& status = known.second;
    return status.robot == robot.name && status.mission == robot.mission->number && status.mission > 0;
  };
  const auto order = std::ranges::find_if(orders_, serves);
  return order != orders_.end() ? &order->second.order : nullptr;
}

void FleetMoment::receive(const RobotState& state, WallTime at) {
  if (state.passed_on) {
    const auto now = time_at(at);
    if (state.counts_as_failed && now) failed_.emplace(state.robot, *now);
    return;
  }
  failed_.erase(state.robot);
  if (state.robot != listener_) return;
  for (const Echo& echo : state.echoes) {
    Echo& last = heard_[echo.robot];
    if (echo.received >= last.received) last = echo;
  }
  for (const ReservationId& known : state.knows) heeded_[known.robot] = known.number;
}

void FleetMoment::receive(const ReservationMessage& message, WallTime) {
  const SaidReservation* const last = reservation(message.robot);
  const bool is_new = last == nullptr || last->message.run != message.run;
  if (!is_new && message.number <= last->message.number) return;
  const bool had_one = !is_new && last->has_trajectory();
  reservations_.insert_or_assign(message.robot,
                                 SaidReservation{message, message.trajectory.empty() && had_one});
}

}  // namespace coppice
