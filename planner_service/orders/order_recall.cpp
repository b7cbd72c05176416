// Part of class OrderBook: what it knows of orders that have ended, and what is saved and recalled.
#include <algorithm>
#include <cstdint>
#include <utility>

#include "planner_service/orders/order_book.h"

namespace coppice {

namespace {

// Ended orders that a restarted service tells anew, the newest ones. Of older ones the book knows that they
// have ended.
constexpr std::size_t most_told_again = 1000;

}  // namespace

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
  if (known == orders_.end()) turn_.add(id, status.order.priority);
  orders_[id] = status;
  if (is_ended(status.state)) {
    turn_.remove(id);
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
  for (const std::string& id : turn_.ids()) change(at(id));
  halts_changed_ = true;
}

std::vector<Message> OrderBook::saved() const {
  std::vector<Message> all{halts_};
  for (OrderStatus& status : ended()) all.emplace_back(std::move(status));
  for (const std::string& id : turn_.ids()) all.emplace_back(orders_.at(id));
  return all;
}

}  // namespace coppice
