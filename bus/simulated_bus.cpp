#include "bus/simulated_bus.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "bus/topics.h"
#include "bus/validation.h"

namespace coppice {

namespace {

std::string key_of(const MapMessage& m) {
  return m.map_id;
}
std::string key_of(const InactiveTreeMessage& m) {
  return std::to_string(m.tree.broker) + "/" + std::to_string(m.tree.number);
}
std::string key_of(const BrokerStatus& m) {
  return std::to_string(m.broker);
}
std::string key_of(const JointPlanMessage& m) {
  return m.knot.leader;
}
std::string key_of(const auto& m) {
  return m.robot;
}

template <class Fn>
auto with_topic(const Message& message, Fn&& fn) {
  return std::visit([&]<class M>(const M& m) { return fn(Topic<M>{}, m); }, message);
}

bool read_by(const Message& message, Role role) {
  return with_topic(message, [&](auto topic, const auto&) { return topic.read_by(role); });
}

}  // namespace

SimulatedBus::Port& SimulatedBus::attach(Role role) {
  ports_.push_back(std::unique_ptr<Port>(new Port(*this, role)));
  Port& port = *ports_.back();
  for (const auto& [key, messages] : kept_) {
    for (const Message& message : messages) {
      if (read_by(message, role)) port.inbox_.push_back({now_ + delay_, message});
    }
  }
  return port;
}

void SimulatedBus::publish(const Port& sender, const Message& message) {
  if (problem_with(message)) return;  // what a reader would drop
  with_topic(message, [&](auto topic, const auto& m) {
    if (topic.info.durability != Durability::transient_local) return;
    const std::string key = std::string(topic.info.name) + "/" + key_of(m);
    const auto [entry, fresh] = kept_index_.try_emplace(key, kept_.size());
    if (fresh) kept_.emplace_back(key, std::vector<Message>{});
    auto& kept = kept_[entry->second].second;
    if (topic.info.depth > 0 && kept.size() >= static_cast<std::size_t>(topic.info.depth))
      kept.erase(kept.begin());
    kept.push_back(message);
  });
  for (const auto& port : ports_) {
    if (port.get() != &sender && read_by(message, port->role_))
      port->inbox_.push_back({now_ + delay_, message});
  }
}

std::vector<Message> SimulatedBus::Port::take() {
  const auto end = std::ranges::find_if(inbox_, [&](const UnderWay& m) { return m.due > bus_.now_; });
  std::vector<Message> due;
  for (auto m = inbox_.begin(); m != end; ++m) due.push_back(std::move(m->message));
  inbox_.erase(inbox_.begin(), end);
  return due;
}

double SimulatedBus::Port::next_delivery() const {
  return inbox_.empty() ? std::numeric_limits<double>::infinity() : inbox_.front().due;
}

}  // namespace coppice
