#include "simulation/simulated_bus.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "messages/message_key.h"
#include "messages/validation.h"

namespace coppice {

namespace {

template <class Fn>
auto with_topic(const Message& message, Fn&& fn) {
  return std::visit([&]<class M>(const M&) { return fn(Topic<M>{}); }, message);
}

// Seconds after which a lost reliable sample is sent again.
constexpr double resend_period = 0.1;

bool read_by(const Message& message, Role role) {
  return with_topic(message, [&](auto topic) { return topic.read_by(role); });
}

}  // namespace

SimulatedBus::Port& SimulatedBus::attach(Role role, const RobotName& robot, int side) {
  ports_.push_back(std::unique_ptr<Port>(new Port(*this, ports_.size(), robot, side)));
  Port& port = *ports_.back();
  by_role_[static_cast<std::size_t>(role)].push_back(&port);
  if (!robot.empty()) {
    const auto [number, fresh] = robots_.insert(robot);
    if (fresh) port_of_robot_.push_back(nullptr);
    port_of_robot_[number] = &port;
  }
  for (const auto& [key, messages] : kept_) {
    for (const Kept& kept : messages) {
      if (read_by(*kept.message, role)) port.deliver(now_ + delay_, kept.message, Reliability::reliable);
    }
  }
  return port;
}

void SimulatedBus::publish(const Port& sender, Outgoing outgoing) {
  if (problem_with(outgoing.message)) {  // a reader would drop it
    ++rejected_;
    return;
  }
  const auto shared = std::make_shared<const Message>(std::move(outgoing.message));
  const Message& message = *shared;
  const TopicInfo info = with_topic(message, [&](auto topic) {
    if (topic.info.durability != Durability::transient_local) return topic.info;
    if (late_ && !topic.read_by(*late_)) return topic.info;
    const std::string key = std::string(topic.info.name) + "/" + key_of(message);
    const auto [entry, fresh] = kept_index_.try_emplace(key, kept_.size());
    if (fresh) kept_.emplace_back(key, std::vector<Kept>{});
    auto& kept = kept_[entry->second].second;
    if (topic.info.depth > 0 && kept.size() >= static_cast<std::size_t>(topic.info.depth))
      kept.erase(kept.begin());
    kept.push_back({sender.index_, shared});
    return topic.info;
  });
  for (const Role role : {Role::service, Role::broker, Role::agent, Role::observer, Role::claimant}) {
    const bool chosen = role == Role::agent && outgoing.agents;
    if (chosen || !read_by(message, role)) continue;
    for (Port* port : by_role_[static_cast<std::size_t>(role)]) send(sender, *port, shared, info.reliability);
  }
  if (!outgoing.agents) return;
  for (const RobotName& robot : *outgoing.agents) {
    if (const auto number = robots_.find(robot))
      send(sender, *port_of_robot_[*number], shared, info.reliability);
  }
}

void SimulatedBus::send(const Port& sender, Port& receiver, const std::shared_ptr<const Message>& message,
                        Reliability reliability) {
  if (&receiver == &sender || receiver.closed_) return;
  double sent = now_;
  while (fails(sender, receiver, sent)) {
    ++lost_;
    if (reliability == Reliability::best_effort) return;
    sent += resend_period;
  }
  double due = sent + delay_of_a_sample();
  // Samples that take different times still arrive in the order of sending.
  if (reliability == Reliability::reliable || (faults_.jitter > 0 && !faults_.reorder)) {
    std::vector<double>& last = receiver.last_due_[static_cast<std::size_t>(reliability)];
    if (last.size() <= sender.index_) last.resize(ports_.size(), 0.0);
    due = last[sender.index_] = std::max(due, last[sender.index_]);
  }
  receiver.deliver(due, message, reliability);
  if (reliability == Reliability::best_effort && faults_.duplicate > 0 &&
      random_.uniform() < faults_.duplicate)
    receiver.deliver(due + delay_of_a_sample(), message, reliability);
}

bool SimulatedBus::is_cut(const Port& sender, const Port& receiver, double time) const {
  const auto lasts = [&](const auto& cut) { return time >= cut.from && time < cut.until; };
  if (sender.side_ != receiver.side_ && std::ranges::any_of(faults_.partitions, lasts)) return true;
  return std::ranges::any_of(faults_.cut_links, [&](const CutLink& cut) {
    const bool between = (cut.a == sender.robot_ && cut.b == receiver.robot_) ||
                         (cut.b == sender.robot_ && cut.a == receiver.robot_);
    return between && lasts(cut);
  });
}

bool SimulatedBus::fails(const Port& sender, const Port& receiver, double time) {
  return is_cut(sender, receiver, time) || (faults_.loss > 0 && random_.uniform() < faults_.loss);
}

double SimulatedBus::delay_of_a_sample() {
  if (faults_.jitter <= 0) return delay_ + faults_.delay;
  return delay_ + std::max(0.0, faults_.delay + random_.uniform(-faults_.jitter, faults_.jitter));
}

void SimulatedBus::Port::deliver(double due, const std::shared_ptr<const Message>& message,
                                 Reliability reliability) {
  inbox_.push_back({{message, due}, reliability});
  if (reliability == Reliability::reliable) next_delivery_ = std::min(next_delivery_, due);
}

std::vector<Arrival> SimulatedBus::Port::take() {
  const auto is_due = [&](const Delivery& d) { return d.arrival.at <= bus_.now_; };
  const auto not_due = std::ranges::find_if_not(inbox_, is_due);
  const bool in_order = std::none_of(not_due, inbox_.end(), is_due);
  const auto later = in_order ? not_due : std::stable_partition(not_due, inbox_.end(), is_due);
  const auto earlier = [](const Delivery& a, const Delivery& b) { return a.arrival.at < b.arrival.at; };
  if (!std::is_sorted(inbox_.begin(), later, earlier)) std::stable_sort(inbox_.begin(), later, earlier);
  std::vector<Arrival> due;
  due.reserve(static_cast<std::size_t>(later - inbox_.begin()));
  for (auto d = inbox_.begin(); d != later; ++d) due.push_back(std::move(d->arrival));
  inbox_.erase(inbox_.begin(), later);
  next_delivery_ = std::numeric_limits<double>::infinity();
  for (const Delivery& d : inbox_) {
    if (d.reliability == Reliability::reliable) next_delivery_ = std::min(next_delivery_, d.arrival.at);
  }
  return due;
}

void SimulatedBus::Port::close() {
  closed_ = true;
  for (auto& [key, messages] : bus_.kept_)
    std::erase_if(messages, [&](const Kept& kept) { return kept.sender == index_; });
  inbox_.clear();
  next_delivery_ = std::numeric_limits<double>::infinity();
}

}  // namespace coppice
