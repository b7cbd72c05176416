#include "planner_service/order_book.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace coppice {

namespace {

// Ended orders that a restarted service tells anew, the newest ones.
constexpr std::size_t most_told_again = 1000;
constexpr std::size_t most_open = 10'000;
constexpr const char* out_of_service =
    "the robot is out of service: its agent was restarted without what it had saved";

/// Empty: the order is for any robot.
RobotName named_robot(const OrderMessage& order) {
  return order.robots.empty() ? RobotName() : order.robots.front();
}

Halt halt_by(Action action, Halt before) {
  switch (action) {
    case Action::stop:
      return Halt::stopped;
    case Action::pause:
      return before == Halt::none ? Halt::paused : before;
    case Action::resume:
      return before == Halt::paused ? Halt::none : before;
    case Action::release:
      return before == Halt::stopped ? Halt::none : before;
    case Action::go:
    case Action::cancel:
      break;
  }
  return before;
}

}  // namespace

OrderBook::OrderBook(std::vector<RobotName> robots) : robots_(std::move(robots)), order_of_(robots_.size()) {}

std::optional<std::size_t> OrderBook::index_of(const RobotName& robot) const {
  const auto known = std::ranges::find(robots_, robot);
  return known == robots_.end() ? std::nullopt : std::optional<std::size_t>(known - robots_.begin());
}

/// All robots if it names none.
std::vector<std::size_t> OrderBook::named_in(const OrderMessage& order) const {
  std::vector<std::size_t> named;
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    if (order.robots.empty() || std::ranges::count(order.robots, robots_[k]) > 0) named.push_back(k);
  }
  return named;
}

std::string OrderBook::problem_with(const OrderMessage& order) const {
  for (const RobotName& robot : order.robots) {
    if (!index_of(robot)) return fmt::format("{} is no robot of this fleet", robot);
  }
  if (order.action == Action::go && turn_.size() >= most_open)
    return fmt::format("{} orders wait already", most_open);
  if (order.action == Action::cancel && !orders_.contains(order.cancels))
    return fmt::format("there is no order {}", order.cancels);
  return {};
}

void OrderBook::receive(const OrderMessage& order, const std::string& refusal, WallTime now) {
  if (knows(order.id)) return;
  const std::string problem = refusal.empty() ? problem_with(order) : refusal;
  OrderStatus& status = orders_[order.id];
  status.order = order;
  status.accepted_at = now;
  // Before orders of less priority, and after all others.
  const auto place = std::ranges::find_if(
      turn_, [&](const std::string& id) { return at(id).order.priority < order.priority; });
  turn_.insert(place, order.id);
  change(status);
  if (!problem.empty()) {
    end(status, OrderState::failed, problem, now);
  } else if (order.action == Action::cancel) {
    cancel(status, now);
  } else if (order.action != Action::go) {
    halt(order, now);
  }
}

void OrderBook::cancel(OrderStatus& cancelling, WallTime now) {
  OrderStatus& target = at(cancelling.order.cancels);
  if (is_ended(target.state)) {
    const auto name = order_state_names[static_cast<std::size_t>(target.state)];
    return end(cancelling, OrderState::failed, fmt::format("order {} is {} already", target.order.id, name),
               now);
  }
  const std::optional<std::size_t> robot =
      target.state == OrderState::under_way ? index_of(target.robot) : std::nullopt;
  end(target, OrderState::cancelled, {}, now);
  if (robot) to_stop_.insert(*robot);
  end(cancelling, OrderState::done, {}, now);
}

/// The number grows also if an earlier service left nothing to go on with.
void OrderBook::halt(const OrderMessage& order, WallTime now) {
  std::vector<Halt> halts;
  for (std::size_t k = 0; k < robots_.size(); ++k) halts.push_back(halt_of(k));
  for (const std::size_t k : named_in(order)) halts[k] = halt_by(order.action, halts[k]);
  // An agent that joins later is bound by what holds for everybody.
  if (order.robots.empty()) halts_.everybody = halt_by(order.action, halts_.everybody);
  halts_.robots.clear();
  for (std::size_t k = 0; k < robots_.size(); ++k) {
    if (halts[k] != halts_.everybody) halts_.robots.push_back({robots_[k], halts[k]});
  }
  halts_.number = std::max(halts_.number + 1, static_cast<std::uint64_t>(1000 * std::max(0.0, now)));
  halts_changed_ = true;
}

void OrderBook::change(OrderStatus& status) {
  if (std::ranges::count(changed_, status.order.id) == 0) changed_.push_back(status.order.id);
}

void OrderBook::end(OrderStatus& status, OrderState state, const std::string& reason, WallTime now) {
  status.state = state;
  status.reason = reason;
  status.ended_at = now;
  std::erase(turn_, status.order.id);
  ended_.push_back(status.order.id);
  const auto robot = index_of(status.robot);
  if (robot && order_of_[*robot] == status.order.id) order_of_[*robot].reset();
  change(status);
}

/// The statuses of an order come in the order in which they were said.
void OrderBook::recall(const OrderStatus& status) {
  const std::string& id = status.order.id;
  const auto known = orders_.find(id);
  const bool had_ended = known != orders_.end() && is_ended(known->second.state);
  if (known != orders_.end() && !known->second.robot.empty()) {
    auto& before = order_of_[*index_of(known->second.robot)];
    if (before == id) before.reset();
  }
  if (known == orders_.end()) {
    const auto place = std::ranges::find_if(
        turn_, [&](const std::string& other) { return at(other).order.priority < status.order.priority; });
    turn_.insert(place, id);
  }
  orders_[id] = status;
  if (is_ended(status.state)) {
    std::erase(turn_, id);
    if (!had_ended) ended_.push_back(id);
  } else if (const auto robot = index_of(status.robot)) {
    order_of_[*robot] = id;
  }
}

void OrderBook::publish_again() {
  for (std::size_t k = ended_.size() - std::min(ended_.size(), most_told_again); k < ended_.size(); ++k)
    change(at(ended_[k]));
  for (const std::string& id : turn_) change(at(id));
  halts_changed_ = true;
}

void OrderBook::follow(std::span<const RobotAtWork> robots, double fleet_now, WallTime now) {
  for (const std::string& id : std::vector<std::string>(turn_)) {
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
  if (status.state != OrderState::under_way)
    return wait(status.order.id, why_it_waits(status, number, robot));
  if (!is_its_mission || !robot.arrived_at) return;
  if (fleet_now < *robot.arrived_at + status.order.visits[status.visited].wait) return;
  ++status.visited;
  status.mission = 0;
  if (status.visited == status.order.visits.size()) return end(status, OrderState::done, {}, now);
  status.state = OrderState::assigned;
  change(status);
}

/// Of an order that is not under way. Empty: it is about to begin, or its place is not free (wait()).
std::string OrderBook::why_it_waits(const OrderStatus& status, std::size_t number,
                                    const RobotAtWork& robot) const {
  if (halt_of(number) == Halt::stopped) return fmt::format("{} is stopped by the operator", robots_[number]);
  if (halt_of(number) == Halt::paused) return fmt::format("{} is paused by the operator", robots_[number]);
  if (robot.lost) return fmt::format("the agent of {} does not answer", robots_[number]);
  const OrderStatus* const its_order = order_of(number);
  if (its_order != nullptr && its_order != &status)
    return fmt::format("{} has another order before, {}", robots_[number], its_order->order.id);
  return status.state == OrderState::assigned ? status.reason : std::string();
}

/// It is done when each robot has confirmed what it is to do. A robot whose agent does not answer hears of it
/// when that is back.
void OrderBook::follow_halt(OrderStatus& status, std::span<const RobotAtWork> robots, WallTime now) {
  const auto obeys = [&](std::size_t k) {
    return robots[k].lost || robots[k].halted == (halt_of(k) != Halt::none);
  };
  if (std::ranges::all_of(named_in(status.order), obeys)) end(status, OrderState::done, {}, now);
}

void OrderBook::give_out_named() {
  for (const std::string& id : turn_) {
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
    if (status == nullptr || robots[k].lost || halt_of(k) != Halt::none) continue;
    // A service before this one was killed when it had saved the order, and not yet the mission.
    const bool never_set_out = status->state == OrderState::under_way && robots[k].mission < status->mission;
    if (status->state == OrderState::assigned || never_set_out)
      all.push_back({status->order.id, k, status->order.visits[status->visited]});
  }
  return all;
}

std::vector<const OrderMessage*> OrderBook::open_orders() const {
  std::vector<const OrderMessage*> all;
  for (const std::string& id : turn_) {
    const OrderStatus& status = orders_.at(id);
    const bool is_open = status.state == OrderState::accepted && status.order.action == Action::go;
    if (is_open && status.order.robots.empty()) all.push_back(&status.order);
  }
  return all;
}

std::vector<std::size_t> OrderBook::free_robots(std::span<const RobotAtWork> robots) const {
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < robots.size(); ++k) {
    const bool may_drive = !robots[k].lost && !robots[k].out_of_service && halt_of(k) == Halt::none;
    if (may_drive && !order_of_[k]) all.push_back(k);
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

void OrderBook::close(const std::string& reason, WallTime now) {
  for (const std::string& id : std::vector<std::string>(turn_))
    end(at(id), OrderState::cancelled, reason, now);
}

std::vector<Message> OrderBook::take_news() {
  std::vector<Message> news;
  if (std::exchange(halts_changed_, false)) news.emplace_back(halts_);
  for (const std::string& id : std::exchange(changed_, {})) news.emplace_back(at(id));
  return news;
}

}  // namespace coppice
