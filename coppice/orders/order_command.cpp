#include <algorithm>
#include <ctime>
#include <iostream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "coppice/orders/order_id.h"
#include "coppice/orders/order_options.h"
#include "dds/dds_bus.h"
#include "messages/order_json.h"
#include "messages/validation.h"
#include "monitor/view/fleet_table.h"
#include "monitor/view/fleet_view.h"
#include "runtime/process.h"

namespace coppice {

namespace {

constexpr WallTime between_repeats = 1;  // seconds: the service may be restarted in between
constexpr WallTime time_to_list = 3;     // seconds: to discover the service, and to receive all orders

std::string_view name_of(OrderState state) {
  return order_state_names.at(static_cast<std::size_t>(state));
}

std::string clock_time(WallTime at) {
  return fmt::format("{:%H:%M:%S}", fmt::localtime(static_cast<std::time_t>(at)));
}

/// "order 3f21: under way by r3", with the reason if there is one.
std::string line_of(const OrderStatus& status) {
  std::string line = fmt::format("order {}: {}", status.order.id, name_of(status.state));
  if (!status.robot.empty())
    line += fmt::format(" {} {}", status.state == OrderState::assigned ? "to" : "by", status.robot);
  if (status.state == OrderState::done && status.begun_at > 0)
    line += fmt::format(", {:.1f} s after it was given", status.ended_at - status.accepted_at);
  if (status.state == OrderState::done && status.order.deadline > 0 &&
      status.ended_at > status.order.deadline)
    line += fmt::format(", {:.1f} s late", status.ended_at - status.order.deadline);
  if (!status.reason.empty()) line += ": " + status.reason;
  return line;
}

/// ", about 12 s to go" if its robot is on its way to the next place; else empty.
std::string rest_of(const OrderStatus& status, const FleetView& view, double fleet_now, WallTime now) {
  const auto robot = view.find(status.robot);
  if (status.state != OrderState::under_way || !robot) return {};
  const auto left = time_left(view.robots()[*robot], fleet_now, now);
  return left ? fmt::format(", about {:.0f} s to go", *left) : std::string();
}

std::vector<OrderMessage> orders_of(const OrderOptions& options, WallTime now) {
  OrderMessage order = options.order;
  if (options.deadline) order.deadline = now + *options.deadline;
  std::vector<OrderMessage> orders;
  if (!options.each) orders.push_back(order);
  for (const Visit& visit : options.each ? options.order.visits : std::vector<Visit>()) {
    orders.push_back(order);
    orders.back().visits = {visit};
  }
  for (OrderMessage& own : orders) own.id = draw_order_id();
  return orders;
}

/// What became of orders so far, by id.
class Answers {
 public:
  explicit Answers(const std::vector<OrderMessage>& orders) {
    for (const OrderMessage& order : orders) last_[order.id];
  }
  /// True if the message is news of these orders.
  const OrderStatus* take(const Arrival& arrival) {
    const auto* const status = std::get_if<OrderStatus>(arrival.message.get());
    if (status == nullptr) return nullptr;
    const auto own = last_.find(status->order.id);
    if (own == last_.end() || own->second == *status) return nullptr;
    own->second = *status;
    return status;
  }
  bool are_answered() const {
    return all_of([](const OrderStatus& s) { return s.accepted_at > 0; });
  }
  bool have_ended() const {
    return all_of([](const OrderStatus& s) { return is_ended(s.state); });
  }
  bool has_failed() const {
    return !all_of([](const OrderStatus& s) { return !is_ended(s.state) || s.state == OrderState::done; });
  }

 private:
  template <class Holds>
  bool all_of(Holds&& holds) const {
    return std::ranges::all_of(last_, [&](const auto& entry) { return holds(entry.second); });
  }
  std::map<std::string, OrderStatus> last_;
};

}  // namespace

int give_order_command(const OrderOptions& options) {
  install_stop_signals();
  ProcessClock clock;
  const std::vector<OrderMessage> orders = orders_of(options, clock.by_system(clock.now()));
  for (const OrderMessage& order : orders) {
    if (const auto problem = problem_with(Message(order))) throw std::runtime_error(*problem);
  }
  DdsBus bus(options.network, Role::dispatcher, "dispatcher");
  Answers answers(orders);
  const WallTime begin = clock.now();
  WallTime next = begin;
  while (!stop_requested() && !(options.wait ? answers.have_ended() : answers.are_answered())) {
    const WallTime now = clock.now();
    if (!answers.are_answered() && now - begin > options.patience) {
      std::cerr << fmt::format(
          "nobody on domain {} has answered within {:g} s: is there a fleet of coppice serve?\n",
          options.network.domain, options.patience);
      return 1;
    }
    if (!answers.are_answered() && now >= next) {
      for (const OrderMessage& order : orders) bus.publish(Message(order));
      next = now + between_repeats;
    }
    bus.wait(longest_wait);
    for (const Arrival& arrival : take(bus, clock)) {
      if (const OrderStatus* const status = answers.take(arrival))
        std::cout << (options.as_json ? json_of(*status) : line_of(*status)) << std::endl;
    }
  }
  return answers.has_failed() || !answers.are_answered() || (options.wait && !answers.have_ended()) ? 1 : 0;
}

int orders_command(const OrderOptions& options) {
  install_stop_signals();
  DdsBus bus(options.network, Role::viewer, "orders");
  FleetView view;
  std::map<std::string, OrderStatus> orders;
  ProcessClock clock;
  const WallTime end = clock.now() + time_to_list;
  while (clock.now() < end && !stop_requested()) {
    bus.wait(longest_wait);
    for (const Arrival& arrival : take(bus, clock)) {
      view.on(arrival.message, arrival.at);
      if (const auto* status = std::get_if<OrderStatus>(arrival.message.get()))
        orders[status->order.id] = *status;
    }
  }
  std::vector<OrderStatus> listed;
  for (const auto& [id, status] : orders) {
    if (options.all || !is_ended(status.state)) listed.push_back(status);
  }
  std::ranges::sort(listed, {}, &OrderStatus::accepted_at);
  const WallTime now = clock.now();
  const double fleet_now = view.fleet_time(now).value_or(0);
  for (const OrderStatus& status : listed) {
    std::cout << (options.as_json ? json_of(status)
                                  : clock_time(status.accepted_at) + "  " + line_of(status) +
                                        rest_of(status, view, fleet_now, now))
              << '\n';
  }
  if (view.service() && !view.service()->status.problem.empty())
    std::cerr << "new orders are refused: " << view.service()->status.problem << '\n';
  if (options.as_json) return view.robots().empty() ? 1 : 0;
  if (listed.empty()) std::cout << "no orders\n";
  std::vector<SeenRobot> robots(view.robots().begin(), view.robots().end());
  std::ranges::sort(robots, sorts_before, &SeenRobot::name);
  for (const SeenRobot& robot : robots) {
    const std::string sentence = sentence_of(robot, fleet_now, now);
    if (!sentence.empty()) std::cout << fmt::format("{}: {}\n", robot.name, sentence);
  }
  return view.robots().empty() ? 1 : 0;
}

}  // namespace coppice
