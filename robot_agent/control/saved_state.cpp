#include "robot_agent/control/saved_state.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <variant>

#include "robot_agent/control/track_log.h"
#include "robot_agent/limits.h"
#include "robot_agent/peers/fleet.h"

namespace coppice {

void SavedStateBuilder::add(const Message& message) {
  std::visit(
      [&](const auto& m) {
        if constexpr (requires { receive(m); }) receive(m);
      },
      message);
}

/// A mission of another run begins all anew: the journal of that one is dropped.
void SavedStateBuilder::receive(const Mission& mission) {
  if (mission_ && mission_->clock != mission.clock) *this = SavedStateBuilder(leads_);
  mission_ = mission;
}

/// Forgets the oldest points, many at a time.
void SavedStateBuilder::bound_track() {
  if (track_.size() <= 2 * track_points_kept) return;
  const std::size_t forgotten = track_.size() - track_points_kept;
  track_.erase(track_.begin(), track_.begin() + static_cast<std::ptrdiff_t>(forgotten));
  first_index_ += static_cast<std::uint32_t>(forgotten);
}

/// Drives the body on by itself until then. Adds the points that the agent has put into its track meanwhile
/// (Run::control).
void SavedStateBuilder::drive_on(double until) {
  Driver& body = saved_->body;
  while (body.time() + body.period() / 2 < until) {
    if (body.stands() && until - body.time() > longest_sleep) return;
    if (!leads_) track_.push_back(point_of(body));
    saved_->driven_length += body.period() * body.velocity().norm();
    body.advance();
    bound_track();
  }
}

void SavedStateBuilder::receive(const RobotState& state) {
  if (!mission_) return;
  if (state.passed_on) {
    // It was heard before the control step that passes it on, which may come nearly a period late.
    if (saved_) silent_[state.robot] = {state, saved_->body.time() + control_period};
  } else if (state.robot != mission_->robot) {
    silent_.erase(state.robot);
  } else {
    const Driver body(state.promise, state.radius, limits_of(state), control_period);
    if (!saved_) saved_ = SavedState{.mission = *mission_, .body = body};
    drive_on(state.promise.stamp);
    saved_->body = body;
    saved_->sequence = state.sequence;
    state_ = state;
    // A process that was started anew has left its predecessor's part in a round, and has not told the
    // others.
    if (state.round.epoch == 0) return;
    saved_->round_epoch = state.round.epoch;
    saved_->stage = state.stage;
    in_round_ = state;
  }
}

void SavedStateBuilder::receive(const AgentStatus& status) {
  if (!saved_) return;
  status_ = saved_->status = status;
  saved_->driven_length = status.driven_length;
}

/// Without a robot that follows, it is the end of the track until the last state. With one, it is what was
/// sent; a process that was started anew has sent some of it again.
void SavedStateBuilder::receive(const TrackMessage& track) {
  const bool goes_on = leads_ && !track_.empty() && track.first_index <= first_index_ + track_.size();
  if (!goes_on) {
    track_.clear();
    first_index_ = track.first_index;
  }
  const std::uint32_t end = first_index_ + static_cast<std::uint32_t>(track_.size());
  const std::size_t known =
      std::min<std::size_t>(track.points.size(), end - std::min(end, track.first_index));
  track_.insert(track_.end(), track.points.begin() + static_cast<std::ptrdiff_t>(known), track.points.end());
  bound_track();
}

std::optional<SavedState> SavedStateBuilder::saved_state() const {
  if (!saved_) return std::nullopt;
  SavedState saved = *saved_;
  saved.mission = *mission_;
  const std::size_t left_out = track_.size() - std::min(track_.size(), track_points_kept);
  saved.track.assign(track_.begin() + static_cast<std::ptrdiff_t>(left_out), track_.end());
  saved.first_index = first_index_ + static_cast<std::uint32_t>(left_out);
  for (const auto& [robot, last] : silent_) saved.silent.push_back(last);
  return saved;
}

std::vector<Message> SavedStateBuilder::messages() const {
  std::vector<Message> all;
  if (!mission_) return all;
  all.emplace_back(*mission_);
  const std::optional<SavedState> saved = saved_state();
  if (!saved) return all;
  if (in_round_ && in_round_ != state_) all.emplace_back(*in_round_);
  all.emplace_back(*state_);
  if (!saved->track.empty())
    all.emplace_back(TrackMessage{mission_->robot, mission_->number, saved->first_index, saved->track,
                                  mission_->clock.run()});
  for (const Heard& last : saved->silent) all.emplace_back(last.state);
  if (!status_) return all;
  AgentStatus status = *status_;
  status.driven_length = saved->driven_length;
  all.emplace_back(std::move(status));
  return all;
}

std::optional<SavedState> saved_state_of(std::span<const Message> kept, bool leads) {
  SavedStateBuilder recollection(leads);
  for (const Message& message : kept) recollection.add(message);
  return recollection.saved_state();
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
    choose_heard(message);
    choose_said(message);
    kept_.add(message);
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
  return noted(choose_heard(message), message);
}

Keep StateKeeper::said(const Message& message) {
  return noted(choose_said(message), message);
}

Keep StateKeeper::noted(Keep choice, const Message& message) {
  if (choice != Keep::nothing) kept_.add(slim(message));
  return choice;
}

/// Whom the robot hears, and what it knows of others, is of use at once only.
Message StateKeeper::slim(const Message& message) {
  const auto* const state = std::get_if<RobotState>(&message);
  if (state == nullptr || state->passed_on) return message;
  RobotState own = *state;
  own.misses.clear();
  own.echoes.clear();
  own.knows.clear();
  return own;
}

Keep StateKeeper::choose_heard(const Message& message) {
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

Keep StateKeeper::choose_said(const Message& message) {
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
