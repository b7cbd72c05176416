#include "bus/simulated_bus.h"

#include <algorithm>
#include <limits>
#include <utility>

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

// A reliable sample that was lost is asked for again about so often, seconds.
constexpr double resend_period = 0.1;

bool read_by(const Message& message, Role role) {
  return with_topic(message, [&](auto topic, const auto&) { return topic.read_by(role); });
}

}  // namespace

SimulatedBus::Port& SimulatedBus::attach(Role role, int side) {
  ports_.push_back(std::unique_ptr<Port>(new Port(*this, role, side)));
  Port& port = *ports_.back();
  for (const auto& [key, messages] : kept_) {
    for (const auto& message : messages) {
      if (read_by(*message, role)) port.inbox_.emplace(now_ + delay_, message);
    }
  }
  return port;
}

void SimulatedBus::publish(const Port& sender, const Message& message) {
  if (problem_with(message)) return;  // what a reader would drop
  const auto shared = std::make_shared<const Message>(message);
  const TopicInfo info = with_topic(message, [&](auto topic, const auto& m) {
    if (topic.info.durability != Durability::transient_local) return topic.info;
    const std::string key = std::string(topic.info.name) + "/" + key_of(m);
    const auto [entry, fresh] = kept_index_.try_emplace(key, kept_.size());
    if (fresh) kept_.emplace_back(key, std::vector<std::shared_ptr<const Message>>{});
    auto& kept = kept_[entry->second].second;
    if (topic.info.depth > 0 && kept.size() >= static_cast<std::size_t>(topic.info.depth))
      kept.erase(kept.begin());
    kept.push_back(shared);
    return topic.info;
  });
  for (const auto& port : ports_) {
    if (port.get() != &sender && !port->closed_ && read_by(message, port->role_))
      send(sender, *port, shared, info.reliability);
  }
}

void SimulatedBus::send(const Port& sender, Port& receiver, const std::shared_ptr<const Message>& message,
                        Reliability reliability) {
  double sent = now_;
  while (fails(sender, receiver, sent)) {
    if (reliability == Reliability::best_effort) return;
    sent += resend_period;
  }
  double due = sent + delay_of_a_sample();
  if (reliability == Reliability::reliable || !faults_.reorder) {
    double& last = receiver.last_due_[{&sender, reliability}];
    due = last = std::max(due, last);
  }
  receiver.inbox_.emplace(due, message);
  if (reliability == Reliability::best_effort && faults_.duplicate > 0 &&
      random_.uniform() < faults_.duplicate)
    receiver.inbox_.emplace(due + delay_of_a_sample(), message);
}

bool SimulatedBus::fails(const Port& sender, const Port& receiver, double time) {
  const bool cut = sender.side_ != receiver.side_ &&
                   std::ranges::any_of(faults_.partitions,
                                       [&](const Partition& p) { return time >= p.from && time < p.until; });
  return cut || (faults_.loss > 0 && random_.uniform() < faults_.loss);
}

double SimulatedBus::delay_of_a_sample() {
  if (faults_.jitter <= 0) return delay_ + faults_.delay;
  return delay_ + std::max(0.0, faults_.delay + random_.uniform(-faults_.jitter, faults_.jitter));
}

std::vector<Message> SimulatedBus::Port::take() {
  const auto end = inbox_.upper_bound(bus_.now_);
  std::vector<Message> due;
  for (auto m = inbox_.begin(); m != end; ++m) due.push_back(*m->second);
  inbox_.erase(inbox_.begin(), end);
  return due;
}

double SimulatedBus::Port::next_delivery() const {
  return inbox_.empty() ? std::numeric_limits<double>::infinity() : inbox_.begin()->first;
}

void SimulatedBus::Port::close() {
  closed_ = true;
  inbox_.clear();
}

}  // namespace coppice
