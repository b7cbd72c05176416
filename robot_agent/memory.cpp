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
  for (const Message& message : kept) {
    if (const auto* heard = std::get_if<Mission>(&message)) {
      mission = *heard;
    } else if (const auto* state = std::get_if<RobotState>(&message); state != nullptr && mission) {
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
  }
  return memory;
}

void Remembrance::recall(std::span<const Message> kept) {
  for (const Message& message : kept) {
    heard(message);
    said(message);
  }
}

Keep Remembrance::heard(const Message& message) {
  const auto* mission = std::get_if<Mission>(&message);
  if (mission == nullptr || mission->robot != robot_ || mission_ == *mission) return Keep::nothing;
  if (mission_ && mission->clock.epoch < mission_->clock.epoch) return Keep::nothing;  // of an earlier run
  const bool same_run = mission_ && mission_->clock == mission->clock;
  mission_ = *mission;
  return same_run ? Keep::append : Keep::begin_anew;
}

Keep Remembrance::said(const Message& message) {
  if (const auto* state = std::get_if<RobotState>(&message))
    return state->robot == robot_ && state->copy == 0 && !state->passed_on ? Keep::append : Keep::nothing;
  if (std::holds_alternative<TrackMessage>(message)) return leads_ ? Keep::append : Keep::nothing;
  const auto* status = std::get_if<AgentStatus>(&message);
  if (status == nullptr || (status_ && same_progress(*status_, *status))) return Keep::nothing;
  status_ = *status;
  return Keep::append;
}

}  // namespace coppice
