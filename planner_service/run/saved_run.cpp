#include "planner_service/run/saved_run.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace coppice {

void RunKeeper::recall(std::span<const Message> saved) {
  for (const Message& message : saved) {
    said(message);
    heard(message);
  }
}

void RunKeeper::recall(const FleetMemory& memory) {
  said(memory.halts);
  for (const OrderStatus& order : memory.orders) said(order);
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

/// A status that is said again, as an answer, is saved already. What the fleet refused binds nobody.
Keep RunKeeper::choose(const OrderStatus& status) {
  if (is_refused(status)) return Keep::nothing;
  const std::size_t own = std::hash<std::string>()(
      fmt::format("{}|{}|{}|{}|{}|{}|{}|{}", static_cast<int>(status.state), status.robot, status.reason,
                  status.visited, status.mission, status.accepted_at, status.begun_at, status.ended_at));
  const auto [known, is_new] = orders_.try_emplace(status.order.id, own);
  return is_new || std::exchange(known->second, own) != own ? Keep::append_surely : Keep::nothing;
}

Keep RunKeeper::said(const Message& message) {
  if (const auto* order = std::get_if<OrderStatus>(&message)) return choose(*order);
  if (const auto* halts = std::get_if<HaltMessage>(&message)) {
    const bool is_new = !halts_ || *halts_ != *halts;
    halts_ = *halts;
    return is_new ? Keep::append_surely : Keep::nothing;
  }
  const auto* mission = std::get_if<Mission>(&message);
  if (mission == nullptr) return Keep::nothing;
  run_ = mission->clock.run();
  return Keep::append;
}

}  // namespace coppice
