#include "planner_service/order_intake.h"

#include <algorithm>
#include <cstddef>

namespace coppice {

namespace {

constexpr std::size_t most_held = 20'000;  // more than monitors keep: further ones are forged
constexpr WallTime disorder = 1;           // seconds by which arrivals may be out of order

}  // namespace

/// A clock that was set back makes no order older: the fleet began as long ago as before.
void OrderIntake::follow_clock(WallTime now) {
  if (now > last_ - disorder) {
    last_ = std::max(last_, now);
  } else {
    const WallTime back = last_ - now;
    since_ -= back;
    for (auto& [id, held] : held_) held.at -= back;
    last_ = now;
  }
}

bool OrderIntake::takes(const OrderMessage& order, WallTime at, WallTime sent) {
  follow_clock(at);
  if (sent == 0 || sent >= since_) {
    held_.erase(order.id);
    return true;
  }
  if (held_.size() < most_held) held_.try_emplace(order.id, order, at);
  return false;
}

std::vector<OrderMessage> OrderIntake::take_outdated(WallTime now) {
  follow_clock(now);
  std::vector<OrderMessage> all;
  std::erase_if(held_, [&](const auto& entry) {
    const bool is_due = now - entry.second.at > patience;
    if (is_due) all.push_back(entry.second.order);
    return is_due;
  });
  return all;
}

}  // namespace coppice
