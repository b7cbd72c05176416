#include "robot_agent/saved_state.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>

#include "robot_agent/fleet.h"
#include "robot_agent/limits.h"
#include "robot_agent/track_log.h"

namespace coppice {

namespace {

/// Drives the body on by itself until then. Adds the points that the agent has put into its track meanwhile
/// (Run::control).
void drive_on(Driver& body, double until, SavedState& saved) {
  while (body.time() + body.period() / 2 < until) {
    if (body.stands() && until - body.time() > longest_sleep) return;
    saved.track.push_back(point_of(body));
    saved.driven_length += body.period() * body.velocity().norm();
    body.advance();
  }
}

}  // namespace

void SavedStateBuilder::add(const Message& message) {
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m); }) receive(m);
      },
      message);
}

void SavedStateBuilder::receive(const RobotState& state) {
  if (!mission_) return;
  if (state.passed_on) {
    if (saved_) silent_[state.robot] = {state, saved_->body.time()};
  } else if (state.robot != mission_->robot) {
    silent_.erase(state.robot);
  } else {
    const Driver body(state.promise, state.radius, limits_of(state), control_period);
    if (!saved_) saved_ = SavedState{.mission = *mission_, .body = body};
    drive_on(saved_->body, state.promise.stamp, *saved_);
    saved_->body = body;
    saved_->sequence = state.sequence;
    // A process that was started anew has left its predecessor's part in a round, and has not told the
    // others.
    if (state.round.epoch == 0) return;
    saved_->round_epoch = state.round.epoch;
    saved_->stage = state.stage;
  }
}

void SavedStateBuilder::receive(const AgentStatus& status) {
  if (saved_) saved_->status = status;
}

/// A process that was started anew has sent the whole track again.
void SavedStateBuilder::receive(const TrackMessage& track) {
  const std::size_t known = std::min<std::size_t>(
      track.points.size(), seen_.size() - std::min<std::size_t>(seen_.size(), track.first_index));
  seen_.insert(seen_.end(), track.points.begin() + static_cast<std::ptrdiff_t>(known), track.points.end());
}

std::optional<SavedState> SavedStateBuilder::saved_state() && {
  if (saved_) {
    saved_->mission = *std::move(mission_);
    saved_->seen = std::move(seen_);
    for (auto& [robot, last] : silent_) saved_->silent.push_back(std::move(last));
  }
  return std::move(saved_);
}

std::optional<SavedState> saved_state_of(std::span<const Message> kept) {
  SavedStateBuilder recollection;
  for (const Message& message : kept) recollection.add(message);
  return std::move(recollection).saved_state();
}

bool is_of_run(const std::optional<SavedState>& saved, const Mission& mission) {
  return saved && saved->mission.clock == mission.clock && saved->mission.map_id == mission.map_id;
}

bool passes_over(const Mission& mission, const RunId& run, const std::optional<Mission>& own) {
  const bool is_over = own && own->clock.run() == run && own->cancelled;
  return mission.clock.run() < run && (mission.cancelled || !is_over);
}

void StateKeeper::restore(std::span<const Message> kept) {
  for (const Message& message : kept) {
    heard(message);
    said(message);
  }
  run_.reset();  // the agent has not heard of that run either
}

/// A peer that is heard again is not where it fell silent. False if the peer was not silent.
bool StateKeeper::end_silence(const RobotState& state) {
  const auto silent = passed_on_.find(state.robot);
  if (silent == passed_on_.end() || state.passed_on || state.promise.stamp <= silent->second) return false;
  passed_on_.erase(silent);
  return true;
}

Keep StateKeeper::heard(const Message& message) {
  if (const auto* state = std::get_if<RobotState>(&message))
    return end_silence(*state) ? Keep::append : Keep::nothing;
  const auto* mission = std::get_if<Mission>(&message);
  if (mission == nullptr) return Keep::nothing;
  // The agent does not ignore a run that is earlier than the run of the journal.
  if (run_ && passes_over(*mission, *run_, mission_)) return Keep::nothing;
  run_ = mission->clock.run();
  if (mission->robot != robot_ || mission_ == *mission) return Keep::nothing;
  const bool same_run = mission_ && mission_->clock == mission->clock;
  mission_ = *mission;
  stands_for_good_ = false;
  if (!same_run) passed_on_.clear();
  return same_run ? Keep::append : Keep::begin_anew;
}

Keep StateKeeper::said(const Message& message) {
  if (const auto* state = std::get_if<RobotState>(&message); state != nullptr && state->passed_on) {
    const auto [known, first] = passed_on_.try_emplace(state->robot, state->promise.stamp);
    if (!first && known->second >= state->promise.stamp) return Keep::nothing;
    known->second = state->promise.stamp;
    return Keep::append;
  }
  if (const auto* state = std::get_if<RobotState>(&message)) {
    const bool news = state->robot == robot_ && state->copy == 0 && !stands_for_good_;
    const bool stands = state->promise.stands();
    stands_for_good_ = stands_for_good_ || (news && stands && mission_ && mission_->cancelled);
    return news ? Keep::append : Keep::nothing;
  }
  if (std::holds_alternative<TrackMessage>(message)) return leads_ ? Keep::append : Keep::nothing;
  const auto* status = std::get_if<AgentStatus>(&message);
  if (status == nullptr || (status_ && same_progress(*status_, *status))) return Keep::nothing;
  status_ = *status;
  return Keep::append;
}

}  // namespace coppice
