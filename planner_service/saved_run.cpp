#include "planner_service/saved_run.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace coppice {

void RunKeeper::recall(std::span<const Message> saved) {
  for (const Message& message : saved) {
    said(message);
    heard(message);
  }
}

Keep RunKeeper::heard(const Message& message) {
  if (const auto* path = std::get_if<PathMessage>(&message))
    return is_of_run(*path, run_) ? Keep::append : Keep::nothing;
  if (const auto* track = std::get_if<TrackMessage>(&message)) return choose(*track);
  if (const auto* status = std::get_if<AgentStatus>(&message)) return choose(*status);
  return Keep::nothing;
}

/// An agent that was restarted sends all of its track again, and nothing of it is saved twice. Without its
/// saved state it begins another track. Then its robot is stopped, and a restarted service needs the reason.
Keep RunKeeper::choose(const TrackMessage& track) {
  if (!is_of_run(track, run_) || track.points.empty()) return Keep::nothing;
  const double begins = track.points.front().time;
  const auto [entry, fresh] = tracks_.try_emplace(track.robot, KnownTrack{0, begins});
  KnownTrack& known = entry->second;
  const bool another = track.first_index == 0 && begins != known.begins;
  const std::size_t end = track.first_index + track.points.size();
  const bool longer = end > std::exchange(known.points, std::max(known.points, end));
  return longer || another ? Keep::append : Keep::nothing;
}

Keep RunKeeper::choose(const AgentStatus& status) {
  if (!is_of_run(status, run_) || status.mission == 0) return Keep::nothing;
  const auto [known, fresh] = statuses_.try_emplace(status.robot, status);
  if (!fresh && same_progress(known->second, status)) return Keep::nothing;
  known->second = status;
  return Keep::append;
}

Keep RunKeeper::said(const Message& message) {
  if (std::holds_alternative<OrderStatus>(message) || std::holds_alternative<HaltMessage>(message))
    return Keep::append;
  const auto* mission = std::get_if<Mission>(&message);
  if (mission == nullptr) return Keep::nothing;
  run_ = mission->clock.run();
  return Keep::append;
}

}  // namespace coppice
