#include "planner_service/run_record.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace coppice {

void RunRecord::recall(std::span<const Message> kept) {
  for (const Message& message : kept) {
    said(message);
    heard(message);
  }
}

Keep RunRecord::heard(const Message& message) {
  if (const auto* path = std::get_if<PathMessage>(&message))
    return path->run == run_ ? Keep::append : Keep::nothing;
  if (const auto* track = std::get_if<TrackMessage>(&message)) return choose(*track);
  if (const auto* status = std::get_if<AgentStatus>(&message)) return choose(*status);
  return Keep::nothing;
}

/// An agent that was started anew says all of its track again; or, without its journal, begins another one:
/// then its robot is stopped, and whoever goes on is to know why.
Keep RunRecord::choose(const TrackMessage& track) {
  if (track.run != run_ || track.points.empty()) return Keep::nothing;
  const double begins = track.points.front().time;
  const auto [entry, fresh] = tracks_.try_emplace(track.robot, KnownTrack{0, begins});
  KnownTrack& known = entry->second;
  const bool another = track.first_index == 0 && begins != known.begins;
  const std::size_t end = track.first_index + track.points.size();
  const bool longer = end > std::exchange(known.points, std::max(known.points, end));
  return longer || another ? Keep::append : Keep::nothing;
}

Keep RunRecord::choose(const AgentStatus& status) {
  if (status.run != run_ || status.mission == 0) return Keep::nothing;
  const auto [known, fresh] = statuses_.try_emplace(status.robot, status);
  if (!fresh && same_progress(known->second, status)) return Keep::nothing;
  known->second = status;
  return Keep::append;
}

Keep RunRecord::said(const Message& message) {
  const auto* mission = std::get_if<Mission>(&message);
  if (mission == nullptr) return Keep::nothing;
  run_ = mission->clock.epoch;
  return Keep::append;
}

}  // namespace coppice
