// How many orders a fleet has been given, what became of them, and how long they took.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <set>
#include <string>

#include "messages/messages.h"

namespace coppice {

class OrderCounts {
 public:
  void on(const OrderStatus& status);

  /// Of orders to go somewhere, by OrderState: those that are in it now, and all that have ended in it.
  const std::array<std::size_t, order_state_names.size()>& by_state() const { return by_state_; }
  /// Sums over the orders that have ended, wall seconds: until their robots set out, and from then on.
  double waited() const { return waited_; }
  double under_way() const { return under_way_; }
  std::size_t set_out() const { return set_out_; }  ///< orders in these sums
  std::size_t late() const { return late_; }        ///< done after their deadlines

 private:
  std::array<std::size_t, order_state_names.size()> by_state_{};
  std::map<std::string, OrderState> open_;
  std::set<std::string> ended_;  ///< ids, so that an order that is told of again is not counted again
  std::deque<std::string> in_order_of_end_;
  double waited_ = 0;
  double under_way_ = 0;
  std::size_t set_out_ = 0;
  std::size_t late_ = 0;
};

}  // namespace coppice
