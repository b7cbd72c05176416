#include "robot_agent/memory.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>

#include "robot_agent/fleet.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

/// Every period until then, as the body drives by itself.
void drive_on(Driver& body, double until, Memory& memory) {
  while (body.time() + body.period() / 2 < until) {
    memory.track.push_back({body.time(), body.position(), body.velocity()});
    memory.driven_length += body.period() * body.velocity().norm();
    body.advance();
  }
}

}  // namespace

std::optional<Memory> memory_of(std::span<const Message> kept) {
  std::optional<Mission> mission;
  std::optional<Memory> memory;
  std::vector<TrackMessage::Point> seen;
  std::map<RobotName, Heard> silent;
  for (const Message& message : kept) {
    if (const auto* heard = std::get_if<Mission>(&message)) {
      mission = *heard;
    } else if (const auto* state = std::get_if<RobotState>(&message); state != nullptr && state->passed_on) {
      if (memory) silent[state->robot] = {*state, memory->body.time()};
    } else if (state != nullptr && mission && state->robot != mission->robot) {
      silent.erase(state->robot);
    } else if (state != nullptr && mission) {
      const Driver body(commitment_of(*state, 0), state->radius, limits_of(*state), control_period);
      if (!memory) memory.emplace(*mission, body);
      drive_on(memory->body, state->stamp, *memory);
      memory->body = body;
      memory->sequence = state->sequence;
      memory->knot_epoch = state->knot.epoch;
      memory->stage = state->stage;
    } else if (const auto* status = std::get_if<AgentStatus>(&message); status != nullptr && memory) {
      memory->status = *status;
    } else if (const auto* track = std::get_if<TrackMessage>(&message)) {
      // One that was started anew has said all of it again.
      const std::size_t known = std::min<std::size_t>(
          track->points.size(), seen.size() - std::min<std::size_t>(seen.size(), track->first_index));
      seen.insert(seen.end(), track->points.begin() + static_cast<std::ptrdiff_t>(known),
                  track->points.end());
    }
  }
  if (memory) {
    memory->mission = *mission;
    memory->seen = std::move(seen);
    for (auto& [robot, last] : silent) memory->silent.push_back(std::move(last));
  }
  return memory;
}

void Remembrance::recall(std::span<const Message> kept) {
  for (const Message& message : kept) {
    heard(message);
    said(message);
  }
}

/// Who is heard of again is not where it fell silent. False if it was not silent.
bool Remembrance::end_silence(const RobotState& state) {
  const auto silent = passed_on_.find(state.robot);
  if (silent == passed_on_.end() || state.passed_on || state.stamp <= silent->second) return false;
  passed_on_.erase(silent);
  return true;
}

Keep Remembrance::heard(const Message& message) {
  if (const auto* state = std::get_if<RobotState>(&message))
    return end_silence(*state) ? Keep::append : Keep::nothing;
  const auto* mission = std::get_if<Mission>(&message);
  if (mission == nullptr || mission->robot != robot_ || mission_ == *mission) return Keep::nothing;
  if (mission_ && mission->clock.epoch < mission_->clock.epoch) return Keep::nothing;  // of an earlier run
  const bool same_run = mission_ && mission_->clock == mission->clock;
  mission_ = *mission;
  if (!same_run) passed_on_.clear();
  return same_run ? Keep::append : Keep::begin_anew;
}

Keep Remembrance::said(const Message& message) {
  if (const auto* state = std::get_if<RobotState>(&message); state != nullptr && state->passed_on) {
    const auto [known, first] = passed_on_.try_emplace(state->robot, state->stamp);
    if (!first && known->second >= state->stamp) return Keep::nothing;
    known->second = state->stamp;
    return Keep::append;
  }
  if (const auto* state = std::get_if<RobotState>(&message))
    return state->robot == robot_ && state->copy == 0 ? Keep::append : Keep::nothing;
  if (std::holds_alternative<TrackMessage>(message)) return leads_ ? Keep::append : Keep::nothing;
  const auto* status = std::get_if<AgentStatus>(&message);
  if (status == nullptr || (status_ && same_progress(*status_, *status))) return Keep::nothing;
  status_ = *status;
  return Keep::append;
}

}  // namespace coppice
