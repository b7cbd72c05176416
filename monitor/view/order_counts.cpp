#include "monitor/view/order_counts.h"

#include <algorithm>

namespace coppice {

namespace {

constexpr std::size_t most_remembered =
    100'000;  // ended orders; a service tells of the newest thousand again

}  // namespace

void OrderCounts::on(const OrderStatus& status) {
  const std::string& id = status.order.id;
  if (status.order.action != Action::go || ended_.contains(id)) return;
  const auto [known, fresh] = open_.try_emplace(id, status.state);
  if (!fresh) --by_state_.at(static_cast<std::size_t>(known->second));
  known->second = status.state;
  ++by_state_.at(static_cast<std::size_t>(status.state));
  if (!is_ended(status.state)) return;
  open_.erase(known);
  ended_.insert(id);
  in_order_of_end_.push_back(id);
  if (in_order_of_end_.size() > most_remembered) {
    ended_.erase(in_order_of_end_.front());
    in_order_of_end_.pop_front();
  }
  late_ += status.state == OrderState::done && status.order.deadline > 0 &&
           status.ended_at > status.order.deadline;
  if (status.begun_at == 0) return;
  ++set_out_;
  waited_ += std::max(0.0, status.begun_at - status.accepted_at);
  under_way_ += std::max(0.0, status.ended_at - status.begun_at);
}

}  // namespace coppice
