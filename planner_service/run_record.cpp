#include "planner_service/run_record.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace coppice {

void RunRecord::recall(std::span<const Message> kept) {
  for (const Message& message : kept) heard(message);
}

Keep RunRecord::heard(const Message& message) {
  if (std::holds_alternative<PathMessage>(message)) return Keep::append;
  if (const auto* track = std::get_if<TrackMessage>(&message)) {
    // An agent that was started anew says all of its track again.
    std::size_t& known = track_points_[track->robot];
    const std::size_t end = track->first_index + track->points.size();
    return end > std::exchange(known, std::max(known, end)) ? Keep::append : Keep::nothing;
  }
  const auto* status = std::get_if<AgentStatus>(&message);
  if (status == nullptr || status->mission == 0) return Keep::nothing;
  const auto [known, fresh] = statuses_.try_emplace(status->robot, *status);
  if (!fresh && same_progress(known->second, *status)) return Keep::nothing;
  known->second = *status;
  return Keep::append;
}

Keep RunRecord::said(const Message& message) {
  return std::holds_alternative<Mission>(message) ? Keep::append : Keep::nothing;
}

}  // namespace coppice
