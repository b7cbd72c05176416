// Part of class OrderBook: which robot gets which order, what an order waits for, and when it is done.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "planner_service/orders/order_book.h"
#include "planner_service/orders/order_words.h"

namespace coppice {

namespace {

constexpr const char* out_of_service =
    "the robot is out of service: its agent was restarted without what it had saved";

/// Empty: the order is for any robot.
RobotName named_robot(const OrderMessage& order) {
  return order.robots.empty() ? RobotName() : order.robots.front();
}

bool is_not_heard(const RobotAtWork& robot) {
  return robot.lost || robot.silent;
}

}  // namespace

void OrderBook::follow(std::span<const RobotAtWork> robots, double fleet_now, WallTime now) {
  for (const std::string& id : turn_.copy()) {
    OrderStatus& status = at(id);
    if (status.order.action != Action::go) {
      follow_halt(status, robots, now);
    } else if (const auto robot = robot_of(status)) {
      follow_go(status, *robot, robots[*robot], fleet_now, now);
    }
  }
  give_out_named();
}

/// The robot that has the order, or is to get it; none: any robot.
std::optional<std::size_t> OrderBook::robot_of(const OrderStatus& status) const {
  return index_of(status.robot.empty() ? named_robot(status.order) : status.robot);
}

void OrderBook::follow_go(OrderStatus& status, std::size_t number, const RobotAtWork& robot, double fleet_now,
                          WallTime now) {
  if (robot.out_of_service) return end(status, OrderState::failed, out_of_service, now);
  const bool is_its_mission = status.state == OrderState::under_way && robot.mission == status.mission;
  if (is_its_mission && !robot.no_way.empty()) return end(status, OrderState::failed, robot.no_way, now);
  wait(status.order.id, why_it_waits(status, number, robot));
  if (status.state != OrderState::under_way) return;
  if (!is_its_mission || !robot.arrived_at) return;
  if (fleet_now < *robot.arrived_at + status.order.visits[status.visited].wait) return;
  ++status.visited;
  status.mission = 0;
  if (status.visited == status.order.visits.size()) return end(status, OrderState::done, {}, now);
  status.state = OrderState::assigned;
  change(status);
}

/// Empty: its robot drives, or it is about to begin, or its place is not free (wait()).
std::string OrderBook::why_it_waits(const OrderStatus& status, std::size_t number,
                                    const RobotAtWork& robot) const {
  // Said first, and without a name: a queue of orders is not told anew whenever one of them goes on.
  const OrderStatus* const its_order = order_of(number);
  if (its_order != nullptr && its_order != &status)
    return fmt::format("{} has other orders before", robots_[number]);
  if (is_not_heard(robot))
    return fmt::format("{} is not heard: its agent has ended, hangs, or cannot be reached", robots_[number]);
  if (is_stopped(halt_of(number))) return fmt::format("{} is stopped by the operator", robots_[number]);
  if (is_paused(halt_of(number))) return fmt::format("{} is paused by the operator", robots_[number]);
  return status.state == OrderState::assigned ? status.reason : std::string();
}

/// It is done when each robot has confirmed what it is to do. A robot whose agent does not answer hears of it
/// when that is back.
void OrderBook::follow_halt(OrderStatus& status, std::span<const RobotAtWork> robots, WallTime now) {
  const auto obeys = [&](std::size_t k) {
    return robots[k].lost || robots[k].halted == (halt_of(k) != Halt::none);
  };
  const std::vector<std::size_t> named = named_in(status.order);
  if (!std::ranges::all_of(named, obeys)) return;
  std::vector<RobotName> unheard;
  for (const std::size_t k : named) {
    if (robots[k].lost) unheard.push_back(robots_[k]);
  }
  std::string note = sentence_of(unheard, "is", "not heard, and learns of this when it is back");
  if (note.empty() && status.order.action == Action::release)
    note = who_stays(status.order, is_paused, "paused until it is resumed");
  end(status, OrderState::done, note, now);
}

void OrderBook::give_out_named() {
  for (const std::string& id : turn_.ids()) {
    const OrderStatus& status = at(id);
    if (status.state != OrderState::accepted || status.order.action != Action::go ||
        status.order.robots.empty())
      continue;
    const std::size_t robot = *index_of(status.order.robots.front());
    if (!order_of_[robot]) assign(id, robot);
  }
}

std::vector<DueOrder> OrderBook::due(std::span<const RobotAtWork> robots) const {
  std::vector<DueOrder> all;
  for (std::size_t k = 0; k < robots.size(); ++k) {
    const OrderStatus* const status = order_of(k);
    if (status == nullptr || is_not_heard(robots[k]) || halt_of(k) != Halt::none) continue;
    // A service before this one was killed when it had saved the order, and not yet the mission.
    const bool never_set_out = status->state == OrderState::under_way && robots[k].mission < status->mission;
    if (status->state == OrderState::assigned || never_set_out)
      all.push_back({status->order.id, k, status->order.visits[status->visited]});
  }
  return all;
}

std::vector<const OrderMessage*> OrderBook::open_orders() const {
  std::vector<const OrderMessage*> all;
  for (const std::string& id : turn_.ids()) {
    const OrderStatus& status = orders_.at(id);
    const bool is_open = status.state == OrderState::accepted && status.order.action == Action::go;
    if (is_open && status.order.robots.empty()) all.push_back(&status.order);
  }
  return all;
}

std::vector<std::size_t> OrderBook::free_robots(std::span<const RobotAtWork> robots) const {
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < robots.size(); ++k) {
    const bool may_drive = !is_not_heard(robots[k]) && !robots[k].out_of_service && halt_of(k) == Halt::none;
    if (may_drive && !order_of_[k]) all.push_back(k);
  }
  return all;
}

std::vector<OrderBook::Withdrawal> OrderBook::withdraw(std::span<const RobotAtWork> robots) {
  std::vector<Withdrawal> all;
  for (std::size_t k = 0; k < robots.size(); ++k) {
    const OrderStatus* const own = order_of(k);
    if (own == nullptr || !own->order.robots.empty() || own->visited > 0) continue;
    const bool knows_it = own->state == OrderState::under_way && robots[k].took_up;
    if (!robots[k].is_out_of_reach || knows_it) continue;
    OrderStatus& status = at(own->order.id);
    if (status.state == OrderState::under_way) all.push_back({status.order.id, k});
    order_of_[k].reset();
    status.state = OrderState::accepted;
    status.robot.clear();
    status.mission = 0;
    status.begun_at = 0;
    status.reason = fmt::format("{} had it, and is not heard", robots_[k]);
    change(status);
  }
  return all;
}

void OrderBook::assign(const std::string& id, std::size_t robot) {
  OrderStatus& status = at(id);
  status.state = OrderState::assigned;
  status.robot = robots_[robot];
  status.reason.clear();
  order_of_[robot] = id;
  change(status);
}

void OrderBook::begin(const std::string& id, std::uint32_t mission, WallTime now) {
  OrderStatus& status = at(id);
  status.state = OrderState::under_way;
  status.mission = mission;
  status.reason.clear();
  if (status.begun_at == 0) status.begun_at = now;
  change(status);
}

void OrderBook::wait(const std::string& id, const std::string& reason) {
  OrderStatus& status = at(id);
  if (std::exchange(status.reason, reason) != reason) change(status);
}

void OrderBook::take_robot(std::size_t robot, const std::string& reason, WallTime now) {
  to_stop_.erase(robot);
  if (const auto id = order_of_[robot]) end(at(*id), OrderState::failed, reason, now);
}

const OrderStatus* OrderBook::order_of(std::size_t robot) const {
  return order_of_[robot] ? &orders_.at(*order_of_[robot]) : nullptr;
}

std::vector<std::size_t> OrderBook::take_robots_to_stop() {
  const std::set<std::size_t> all = std::exchange(to_stop_, {});
  return {all.begin(), all.end()};
}

}  // namespace coppice
