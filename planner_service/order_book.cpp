#include "planner_service/order_book.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "planner_service/halts.h"

namespace coppice {

namespace {

// Ended orders that a restarted service tells anew, the newest ones. Of older ones the book knows that they
// have ended.
constexpr std::size_t most_told_again = 1000;
constexpr std::size_t most_refused = 1000;
constexpr std::size_t most_open = 10'000;
constexpr const char* out_of_service =
    "the robot is out of service: its agent was restarted without what it had saved";

/// Empty: the order is for any robot.
RobotName named_robot(const OrderMessage& order) {
  return order.robots.empty() ? RobotName() : order.robots.front();
}

/// " by ann".
std::string sender_of(const OrderMessage& order) {
  return " by " + (order.by.empty() ? "somebody who gave no name" : order.by);
}

bool is_not_heard(const RobotAtWork& robot) {
  return robot.lost || robot.silent;
}

/// "r1 VERB REST", or "r1, r2 and 3 more: each VERB REST", with as many names as fit into a reason; empty:
/// there are none.
std::string sentence_of(const std::vector<RobotName>& robots, const char* verb, const char* rest) {
  constexpr std::size_t most_named = 2;
  if (robots.empty()) return {};
  if (robots.size() == 1) return fmt::format("{} {} {}", robots.front(), verb, rest);
  const std::vector<RobotName> named(robots.begin(), robots.begin() + most_named);
  const std::size_t more = robots.size() - most_named;
  const std::string others = more > 0 ? fmt::format(" and {} more", more) : std::string();
  return fmt::format("{}{}: each {} {}", fmt::join(named, ", "), others, verb, rest);
}

/// Who cancels, and why: "cancelled by anna: replaced by order 4f32".
std::string reason_of(const OrderMessage& cancellation) {
  return fmt::format("cancelled{}{}{}", sender_of(cancellation), cancellation.why.empty() ? "" : ": ",
                     cancellation.why);
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
  if (knows(order.id)) return change(at(order.id));
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
  std::erase(turn_, status.order.id);
  refused_.push_back(status.order.id);
  if (refused_.size() <= most_refused) return;
  std::erase(changed_, refused_.front());
  orders_.erase(refused_.front());
  refused_.pop_front();
}

/// The operator has another use for the robot than what it has to do.
void OrderBook::replace_orders(const OrderStatus& with, WallTime now) {
  const std::optional<std::size_t> robot = index_of(named_robot(with.order));
  const std::string reason = fmt::format("replaced by order {}{}", with.order.id, sender_of(with.order));
  for (const std::string& id : std::vector<std::string>(turn_)) {
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
  if (std::ranges::count(changed_, status.order.id) == 0) changed_.push_back(status.order.id);
}

void OrderBook::end(OrderStatus& status, OrderState state, const std::string& reason, WallTime now) {
  status.state = state;
  status.reason = reason;
  status.ended_at = now;
  std::erase(turn_, status.order.id);
  note_end(status);
  const auto robot = index_of(status.robot);
  if (robot && order_of_[*robot] == status.order.id) order_of_[*robot].reset();
  change(status);
}

/// Of an order that ended long ago the book keeps little: that it has ended.
void OrderBook::note_end(const OrderStatus& status) {
  ended_.push_back(status.order.id);
  if (ended_.size() <= most_told_again) return;
  OrderStatus& oldest = at(ended_.front());
  ended_.pop_front();
  oldest.order.visits.resize(std::min<std::size_t>(oldest.order.visits.size(), 1));
  oldest.visited = std::min<std::uint32_t>(oldest.visited, 1);
  oldest.reason.clear();
  oldest.reason.shrink_to_fit();
  oldest.order.visits.shrink_to_fit();
}

/// The statuses of an order come in the order in which they were said.
void OrderBook::recall(const OrderStatus& status) {
  const std::string& id = status.order.id;
  const auto known = orders_.find(id);
  const bool had_ended = known != orders_.end() && is_ended(known->second.state);
  if (const auto robot = known != orders_.end() ? index_of(known->second.robot) : std::nullopt) {
    if (order_of_[*robot] == id) order_of_[*robot].reset();
  }
  if (known == orders_.end()) {
    const auto place = std::ranges::find_if(
        turn_, [&](const std::string& other) { return at(other).order.priority < status.order.priority; });
    turn_.insert(place, id);
  }
  orders_[id] = status;
  if (is_ended(status.state)) {
    std::erase(turn_, id);
    if (!had_ended) note_end(status);
  } else if (const auto robot = index_of(status.robot)) {
    order_of_[*robot] = id;
  }
}

std::vector<OrderStatus> OrderBook::ended() const {
  std::vector<OrderStatus> all;
  for (const auto& [id, status] : orders_) {
    if (is_ended(status.state) && !is_refused(status)) all.push_back(status);
  }
  std::ranges::stable_sort(all, {}, &OrderStatus::ended_at);
  return all;
}

void OrderBook::publish_again() {
  for (const std::string& id : ended_) change(at(id));
  for (const std::string& id : turn_) change(at(id));
  halts_changed_ = true;
}

std::vector<Message> OrderBook::saved() const {
  std::vector<Message> all{halts_};
  for (OrderStatus& status : ended()) all.emplace_back(std::move(status));
  for (const std::string& id : turn_) all.emplace_back(orders_.at(id));
  return all;
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
