#include "robot_agent/nameless_agent.h"

#include <algorithm>

namespace coppice {

void NamelessAgent::on(const Arrival& arrival) {
  claimant_.on(arrival);
  if (agent_) agent_->on(arrival);
}

std::vector<Outgoing> NamelessAgent::step(WallTime now) {
  std::vector<Outgoing> out = claimant_.step(now);
  if (!agent_ || lost() || agent_->next_wake() > now) return out;
  for (Outgoing& said : agent_->step(now)) out.push_back(std::move(said));
  return out;
}

void NamelessAgent::begin(std::span<const Message> kept, const std::optional<TrackingSettings>& tracking) {
  agent_.emplace(*robot());
  if (tracking) agent_->lead(*tracking);
  agent_->recall(kept);
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
