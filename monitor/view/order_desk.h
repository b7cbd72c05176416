// What a monitor knows of the orders of a fleet: the newest status of each, and the halts.
//
// A state machine: messages go in.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "messages/messages.h"

namespace coppice {

class OrderDesk {
 public:
  /// Of ended orders it knows the newest, as many as a restarted service tells anew (order_book.cpp).
  static constexpr std::size_t most_ended = 1000;
  /// The same of orders that were refused: however many there are, they push out no other order.
  static constexpr std::size_t most_refused = 1000;
  /// Further orders are forged, or more than any fleet can carry out.
  static constexpr std::size_t most_orders = 20'000;

  /// An order that has ended stays as it is, whatever a later fleet says of it. Returns the ids of ended
  /// orders that it forgets in exchange.
  std::vector<std::string> on(const OrderStatus& status);
  /// Returns the ids of orders that it forgets, because their service has gone and the next one does not know
  /// them. A service that goes on with the run knows them.
  std::vector<std::string> on(const ServiceStatus& status);
  void on(const HaltMessage& halts) { halts_ = halts; }

  /// Null: it knows no such order.
  const OrderStatus* find(const std::string& id) const;
  /// In the order in which they were accepted. `state`: only those in this state.
  std::vector<const OrderStatus*> list(std::optional<OrderState> state) const;
  /// The id of the order that a robot has; null: none.
  const std::string* order_of(const RobotName& robot) const;
  const HaltMessage& halts() const { return halts_; }
  /// Why the service refuses new orders; empty: it takes them.
  const std::string& problem() const { return problem_; }

 private:
  std::map<std::string, OrderStatus> orders_;
  std::deque<std::string> ended_;              ///< ids, in the order of their ends
  std::deque<std::string> refused_;            ///< ids, the same
  std::map<RobotName, std::string> by_robot_;  ///< the id of the order that a robot has
  HaltMessage halts_;
  RunId run_;
  std::string problem_;
};

}  // namespace coppice
