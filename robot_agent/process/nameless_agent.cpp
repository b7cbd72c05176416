#include "robot_agent/process/nameless_agent.h"

#include <algorithm>
#include <utility>

namespace coppice {

void NamelessAgent::on(const Arrival& arrival) {
  claimant_.on(arrival);
  if (agent_) agent_->on(arrival);
}

std::vector<Outgoing> NamelessAgent::step(WallTime now) {
  std::vector<Outgoing> out = claimant_.step(now);
  if (!agent_ || lost()) return out;
  for (Outgoing& said : agent_->step(now)) out.push_back(std::move(said));
  return out;
}

void NamelessAgent::note(const BusCounts& counts, WallTime now) {
  if (agent_) agent_->note(counts, now);
}

void NamelessAgent::begin(std::optional<SavedState> saved, const std::optional<TrackingSettings>& tracking) {
  agent_.emplace(*robot());
  if (tracking) agent_->track_robot(*tracking);
  agent_->restore(std::move(saved));
}

void NamelessAgent::retire() {
  if (agent_) agent_->retire();
}

std::vector<Outgoing> NamelessAgent::final_messages(WallTime now) {
  if (!agent_ || lost()) return {};
  return agent_->final_messages(now);
}

WallTime NamelessAgent::next_wake() const {
  return agent_ ? std::min(agent_->next_wake(), claimant_.next_wake()) : claimant_.next_wake();
}

}  // namespace coppice
