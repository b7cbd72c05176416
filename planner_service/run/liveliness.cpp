#include "planner_service/run/liveliness.h"

#include <algorithm>
#include <utility>

#include "planner_service/timing.h"

namespace coppice {

namespace {

WallTime lease_of(AgentStage stage, bool several_are_absent) {
  if (stage == AgentStage::expected) return service_timing.longest_cut_off;
  if (stage == AgentStage::active && several_are_absent) return service_timing.agent_lease_in_split;
  return service_timing.agent_lease;
}

}  // namespace

/// A pause of this process is no silence of the agents.
void Liveliness::follow_clock(WallTime now) {
  const WallTime gap = now - std::exchange(last_step_, now);
  for (Agent& agent : agents_) {
    if (gap > service_timing.longest_step_gap) agent.heard_at += gap;
    agent.heard_at = std::min(agent.heard_at, now);
  }
}

void Liveliness::step(std::span<const AgentStage> stages, WallTime now) {
  follow_clock(now);
  int absent = 0;
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    absent += stages[i] == AgentStage::active && !agents_[i].lost && silence(i, now) > service_timing.absence;
  }
  for (std::size_t i = 0; i < agents_.size(); ++i)
    agents_[i].lost = agents_[i].lost || silence(i, now) > lease_of(stages[i], absent > 1);
}

}  // namespace coppice
