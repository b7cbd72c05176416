#include "monitor/view/order_desk.h"

#include <algorithm>

namespace coppice {

std::vector<std::string> OrderDesk::on(const OrderStatus& status) {
  const std::string& id = status.order.id;
  const auto known = orders_.find(id);
  if (known == orders_.end() && orders_.size() >= most_orders) return {};
  // An order that was refused may be given again.
  if (known != orders_.end() && is_ended(known->second.state) && !is_refused(known->second)) return {};
  const bool was_refused = known != orders_.end() && is_refused(known->second);
  if (was_refused) std::erase(refused_, id);
  orders_[id] = status;
  if (!is_ended(status.state)) {
    if (!status.robot.empty()) by_robot_[status.robot] = id;
    return {};
  }
  if (const auto own = by_robot_.find(status.robot); own != by_robot_.end() && own->second == id)
    by_robot_.erase(own);
  std::deque<std::string>& kind = is_refused(status) ? refused_ : ended_;
  kind.push_back(id);
  if (kind.size() <= (is_refused(status) ? most_refused : most_ended)) return {};
  const std::string oldest = kind.front();
  kind.pop_front();
  orders_.erase(oldest);
  return {oldest};
}

std::vector<std::string> OrderDesk::on(const ServiceStatus& status) {
  if (status.run >= run_) problem_ = status.problem;
  if (status.run <= run_) return {};
  const bool is_another = static_cast<bool>(run_);
  run_ = status.run;
  std::vector<std::string> forgotten;
  for (const auto& [id, order] : orders_) {
    if (is_another && !is_ended(order.state) && order.accepted_at < status.since) forgotten.push_back(id);
  }
  for (const std::string& id : forgotten) orders_.erase(id);
  std::erase_if(by_robot_, [&](const auto& own) { return !orders_.contains(own.second); });
  return forgotten;
}

const OrderStatus* OrderDesk::find(const std::string& id) const {
  const auto known = orders_.find(id);
  return known == orders_.end() ? nullptr : &known->second;
}

std::vector<const OrderStatus*> OrderDesk::list(std::optional<OrderState> state) const {
  std::vector<const OrderStatus*> all;
  for (const auto& [id, status] : orders_) {
    if (!state || status.state == *state) all.push_back(&status);
  }
  std::ranges::stable_sort(all, {}, &OrderStatus::accepted_at);
  return all;
}

const std::string* OrderDesk::order_of(const RobotName& robot) const {
  const auto own = by_robot_.find(robot);
  return own == by_robot_.end() ? nullptr : &own->second;
}

}  // namespace coppice
