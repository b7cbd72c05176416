// The orders of a fleet: what was ordered, whose turn it is, and what became of it.
//
// A state machine without a clock. It knows nothing of missions except their numbers. The service tells it
// what the robots do, asks it which orders are due, and carries these out (serve_orders.cpp). Each change of
// a status is news, which the service saves and publishes before it acts on it. So a service that is killed
// and restarted does no order twice, and forgets none.
//
// order_book.cpp takes orders up, order_progress.cpp gives them to robots, and order_recall.cpp goes on with
// those of a service before this one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "messages/messages.h"
#include "planner_service/orders/order_queue.h"

namespace coppice {

/// What the service knows of a robot, as far as orders need it.
struct RobotAtWork {
  std::uint32_t mission = 0;
  std::optional<double> arrived_at{};  ///< fleet time, in this mission; none: it is under way
  Halt halt = Halt::none;
  bool halted = false;           ///< it has confirmed that
  bool lost = false;             ///< its agent does not answer
  bool silent = false;           ///< its agent is not heard at the moment
  bool is_out_of_reach = false;  ///< for so long that an order that it does not know is for another robot
  bool took_up = false;          ///< its agent has confirmed this mission
  bool out_of_service = false;   ///< it never drives again in this run
  std::string no_way{};          ///< why it does not arrive in this mission; empty: it may
};

/// An order that is given to a robot now.
struct DueOrder {
  std::string id;
  std::size_t robot = 0;
  Visit visit{};
};

class OrderBook {
 public:
  /// `robots`: names, in the order of the scenario.
  explicit OrderBook(std::vector<RobotName> robots);

  /// Takes up an order. An order with the id of an earlier one changes nothing, and is answered again. If
  /// that one was refused, it is new when it is corrected or can be carried out now. `refusal`: why the fleet
  /// can never carry it out; empty: it may. Of the orders that were refused it knows the newest: however many
  /// there are, they push out no other order.
  void receive(const OrderMessage& order, const std::string& refusal, WallTime now);
  /// Whether an order with this id has come before.
  bool knows(const std::string& id) const { return orders_.contains(id); }
  /// Whether it has come before and was not refused.
  bool has_taken(const std::string& id) const { return knows(id) && !is_refused(orders_.at(id)); }
  /// Why an order is wrong in itself; empty if it is not.
  std::string problem_with(const OrderMessage& order) const;

  /// Takes up what a service before this one saved.
  void recall(const OrderStatus& status);
  void recall(const HaltMessage& halts) { halts_ = halts; }
  const HaltMessage& halts() const { return halts_; }
  /// The orders that have ended, in the order of their ends, and of old ones no more than that.
  std::vector<OrderStatus> ended() const;
  /// Publishes again what is not ended, the newest of the ended orders, and the halts.
  void publish_again();
  /// What recall() needs to come to the same orders.
  std::vector<Message> saved() const;

  /// Settles which orders are done, have failed or go on. `fleet_now`: seconds. By robot.
  void follow(std::span<const RobotAtWork> robots, double fleet_now, WallTime now);
  /// The next visits of robots that have an order and are ready for it.
  std::vector<DueOrder> due(std::span<const RobotAtWork> robots) const;
  /// Orders for any robot that can be given out now, the most urgent first, and the robots that are free.
  std::vector<const OrderMessage*> open_orders() const;
  std::vector<std::size_t> free_robots(std::span<const RobotAtWork> robots) const;
  /// An order for any robot, which its robot never heard of: it waits for another robot.
  struct Withdrawal {
    std::string id;
    std::size_t robot = 0;
  };
  /// Takes such orders back. Their robots are to stay where they are, should they be heard again.
  std::vector<Withdrawal> withdraw(std::span<const RobotAtWork> robots);
  /// Gives an accepted order to a free robot.
  void assign(const std::string& id, std::size_t robot);
  /// The robot sets out for the order's next visit in this mission.
  void begin(const std::string& id, std::uint32_t mission, WallTime now);
  /// The order cannot go on yet.
  void wait(const std::string& id, const std::string& reason);
  /// The robot got another goal, not by an order.
  void take_robot(std::size_t robot, const std::string& reason, WallTime now);

  /// Cancels all orders.
  void close(const std::string& reason, WallTime now);

  /// The order that a robot has; null: none.
  const OrderStatus* order_of(std::size_t robot) const;
  /// Robots whose order was cancelled or failed on their way, each once: they are to stop.
  std::vector<std::size_t> take_robots_to_stop();
  Halt halt_of(std::size_t robot) const { return coppice::halt_of(halts_, robots_[robot]); }
  std::vector<Message> take_news();

 private:
  OrderStatus& at(const std::string& id) { return orders_.at(id); }
  void refuse(OrderStatus& status, const std::string& reason, WallTime now);
  void replace_orders(const OrderStatus& with, WallTime now);
  void cancel_order(OrderStatus& order, const std::string& reason, WallTime now);
  std::optional<std::size_t> index_of(const RobotName& robot) const;
  std::vector<std::size_t> named_in(const OrderMessage& order) const;
  void change(OrderStatus& status);
  void note_end(const OrderStatus& status);
  void end(OrderStatus& status, OrderState state, const std::string& reason, WallTime now);
  void cancel(OrderStatus& cancelling, WallTime now);
  void halt(OrderStatus& status, WallTime now);
  std::string who_stays(const OrderMessage& order, bool (*is_held)(Halt), const char* how) const;
  void follow_go(OrderStatus& status, std::size_t number, const RobotAtWork& robot, double fleet_now,
                 WallTime now);
  std::optional<std::size_t> robot_of(const OrderStatus& status) const;
  std::string why_it_waits(const OrderStatus& status, std::size_t number, const RobotAtWork& robot) const;
  void follow_halt(OrderStatus& status, std::span<const RobotAtWork> robots, WallTime now);
  void give_out_named();

  std::vector<RobotName> robots_;
  std::map<std::string, OrderStatus> orders_;
  OrderQueue turn_;                                   ///< of those that are not ended
  std::deque<std::string> ended_;                     ///< ids, in the order of their ends; the newest ones
  std::deque<std::string> refused_;                   ///< ids; the newest ones
  std::vector<std::optional<std::string>> order_of_;  ///< by robot
  std::set<std::size_t> to_stop_;
  HaltMessage halts_;
  bool halts_changed_ = false;
  std::vector<std::string> changed_;            ///< ids, each once
  std::unordered_set<std::string> is_changed_;  ///< the same
};

}  // namespace coppice
