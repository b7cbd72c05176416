#include "planner_service/orders/order_intake.h"

#include <cstddef>

namespace coppice {

namespace {

constexpr std::size_t most_held = 20'000;  // more than monitors keep: further ones are forged

}  // namespace

bool OrderIntake::takes(const OrderMessage& order, WallTime at, WallTime sent) {
  if (sent == 0 || sent >= since_) {
    held_.erase(order.id);
    return true;
  }
  if (held_.size() < most_held) held_.try_emplace(order.id, order, at);
  return false;
}

std::vector<OrderMessage> OrderIntake::take_outdated(WallTime now) {
  std::vector<OrderMessage> all;
  std::erase_if(held_, [&](const auto& entry) {
    const bool is_due = now - entry.second.at > patience;
    if (is_due) all.push_back(entry.second.order);
    return is_due;
  });
  return all;
}

}  // namespace coppice
