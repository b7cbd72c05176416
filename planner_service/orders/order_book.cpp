#include "planner_service/orders/order_book.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "planner_service/orders/halts.h"
#include "planner_service/orders/order_words.h"

namespace coppice {

namespace {

constexpr std::size_t most_refused = 1000;
constexpr std::size_t most_open = 10'000;

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
  const std::string problem = refusal.empty() ? problem_with(order) : refusal;
  if (const auto known = orders_.find(order.id); known != orders_.end()) {
    const bool is_new = order.action == Action::go && is_refused(known->second) &&
                        (problem.empty() || known->second.order != order);
    if (!is_new) return change(known->second);
    std::erase(refused_, order.id);
    orders_.erase(known);
  }
  OrderStatus& status = orders_[order.id];
  status.order = order;
  status.accepted_at = now;
  turn_.add(order.id, order.priority);
  change(status);
  if (!problem.empty()) {
    refuse(status, problem, now);
  } else if (order.action == Action::cancel) {
    cancel(status, now);
  } else if (order.action != Action::go) {
    halt(status, now);
  } else if (order.replaces) {
    replace_orders(status, now);
  }
}

void OrderBook::refuse(OrderStatus& status, const std::string& reason, WallTime now) {
  status.state = OrderState::failed;
  status.reason = reason;
  status.ended_at = now;
  turn_.remove(status.order.id);
  refused_.push_back(status.order.id);
  if (refused_.size() <= most_refused) return;
  orders_.erase(refused_.front());
  refused_.pop_front();
}

/// The operator has another use for the robot than what it has to do.
void OrderBook::replace_orders(const OrderStatus& with, WallTime now) {
  const std::optional<std::size_t> robot = robot_of(with);
  const std::string reason = fmt::format("replaced by order {}{}", with.order.id, sender_of(with.order));
  for (const std::string& id : turn_.copy()) {
    OrderStatus& other = at(id);
    if (other.order.action == Action::go && &other != &with && robot_of(other) == robot)
      cancel_order(other, reason, now);
  }
}

void OrderBook::cancel_order(OrderStatus& order, const std::string& reason, WallTime now) {
  const std::optional<std::size_t> robot =
      order.state == OrderState::under_way ? index_of(order.robot) : std::nullopt;
  end(order, OrderState::cancelled, reason, now);
  if (robot) to_stop_.insert(*robot);
}

void OrderBook::cancel(OrderStatus& cancelling, WallTime now) {
  OrderStatus& target = at(cancelling.order.cancels);
  if (is_ended(target.state)) {
    const auto name = order_state_names[static_cast<std::size_t>(target.state)];
    return refuse(cancelling, fmt::format("order {} is {} already", target.order.id, name), now);
  }
  if (target.order.action != Action::go)
    return refuse(cancelling, fmt::format("order {} sends no robot anywhere", target.order.id), now);
  cancel_order(target, reason_of(cancelling.order), now);
  end(cancelling, OrderState::done, {}, now);
}

void OrderBook::halt(OrderStatus& status, WallTime now) {
  const OrderMessage& order = status.order;
  halts_ = halts_after(halts_, order.action, order.robots, robots_, now);
  halts_changed_ = true;
  status.begun_at = now;
  // Whoever resumes robots expects them to drive.
  if (order.action != Action::resume) return;
  const std::string stopped = who_stays(order, is_stopped, "stopped until it is released");
  if (!stopped.empty()) end(status, OrderState::failed, stopped, now);
}

/// "r1 stays HOW" for the robots that the order names and another halt holds; empty: it holds none.
std::string OrderBook::who_stays(const OrderMessage& order, bool (*is_held)(Halt), const char* how) const {
  std::vector<RobotName> held;
  for (const std::size_t k : named_in(order)) {
    if (is_held(halt_of(k))) held.push_back(robots_[k]);
  }
  return sentence_of(held, "stays", how);
}

void OrderBook::change(OrderStatus& status) {
  if (is_changed_.insert(status.order.id).second) changed_.push_back(status.order.id);
}

void OrderBook::end(OrderStatus& status, OrderState state, const std::string& reason, WallTime now) {
  status.state = state;
  status.reason = reason;
  status.ended_at = now;
  turn_.remove(status.order.id);
  note_end(status);
  const auto robot = index_of(status.robot);
  if (robot && order_of_[*robot] == status.order.id) order_of_[*robot].reset();
  change(status);
}

void OrderBook::close(const std::string& reason, WallTime now) {
  for (const std::string& id : turn_.copy()) end(at(id), OrderState::cancelled, reason, now);
}

std::vector<Message> OrderBook::take_news() {
  std::vector<Message> news;
  if (std::exchange(halts_changed_, false)) news.emplace_back(halts_);
  is_changed_.clear();
  for (const std::string& id : std::exchange(changed_, {})) {
    if (knows(id)) news.emplace_back(at(id));  // else it was refused, and others were refused since
  }
  return news;
}

}  // namespace coppice
