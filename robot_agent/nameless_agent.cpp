#include "robot_agent/nameless_agent.h"

#include <algorithm>
#include <utility>

namespace coppice {

void NamelessAgent::on(const Arrival& arrival) {
  claimant_.on(arrival);
  if (agent_) {
    agent_->on(arrival);
  } else {
    keep(arrival);
  }
}

/// What the bus would keep for a late joiner: the map and its trees, the last mission of each robot and plan
/// of each leader.
void NamelessAgent::keep(const Arrival& arrival) {
  const Message& message = *arrival.message;
  if (const auto* map = std::get_if<MapMessage>(&message)) {
    std::erase_if(kept_, [&](const Arrival& a) {
      const auto* tree = std::get_if<InactiveTreeMessage>(a.message.get());
      return std::holds_alternative<MapMessage>(*a.message) ||
             (tree != nullptr && tree->map_id != map->map_id);
    });
  } else if (const auto* mission = std::get_if<Mission>(&message)) {
    std::erase_if(kept_, [&](const Arrival& a) {
      const auto* earlier = std::get_if<Mission>(a.message.get());
      return earlier != nullptr && earlier->robot == mission->robot;
    });
  } else if (const auto* plan = std::get_if<JointPlanMessage>(&message)) {
    std::erase_if(kept_, [&](const Arrival& a) {
      const auto* earlier = std::get_if<JointPlanMessage>(a.message.get());
      return earlier != nullptr && earlier->knot.leader == plan->knot.leader;
    });
  } else if (!std::holds_alternative<InactiveTreeMessage>(message)) {
    return;
  }
  kept_.push_back(arrival);
}

std::vector<Outgoing> NamelessAgent::step(WallTime now) {
  std::vector<Outgoing> out = claimant_.step(now);
  if (!agent_ || lost() || agent_->next_wake() > now) return out;
  for (Outgoing& said : agent_->step(now)) out.push_back(std::move(said));
  return out;
}

void NamelessAgent::begin(std::span<const Message> kept) {
  agent_.emplace(*robot());
  agent_->recall(kept);
  for (const Arrival& arrival : std::exchange(kept_, {})) agent_->on(arrival);
}

void NamelessAgent::retire() {
  if (agent_) agent_->retire();
}

std::vector<Outgoing> NamelessAgent::last_words(WallTime now) {
  if (!agent_ || lost()) return {};
  return agent_->last_words(now);
}

WallTime NamelessAgent::next_wake() const {
  return agent_ ? std::min(agent_->next_wake(), claimant_.next_wake()) : claimant_.next_wake();
}

}  // namespace coppice
