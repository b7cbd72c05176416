#include "robot_agent/fleet.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace coppice {

namespace {

// Seconds without a state (of the wall's clock, or of fleet time where that is slower: states come by fleet
// time) after which a robot counts as dead: far longer than a pause of a process or a run of lost samples
// lasts, for one that drives on unheard may touch those who think it dead.
constexpr double death = 2;
// The same where others fall silent with it: that looks like a network in pieces, which may heal.
constexpr double longest_split = 30;
constexpr double driven_cut_off = 3;  // seconds that one may drive on until it notices
// Without a state for so long a robot is missing: longer than samples are under way or a process pauses.
constexpr double absence = 1;
constexpr double long_absence = 1.5;
// The same for all others at once, where one is alone: nobody else needs to pause for that.
constexpr double loneliness = 0.6;
// The same for one that was never heard of: its process may still have to start.
constexpr double longest_muster = 10;
// Who falls silent may have sent states that only some have heard: in this time they are passed on.
constexpr double relay_from = 0.3;
constexpr double relay_until = 4;
constexpr std::size_t echoes_a_state = 8;
constexpr double good_clock = 0.0015;  // seconds: three centimetres' drive
constexpr int most_copies = 4;
constexpr double copies_tried = 0.5;  // seconds
constexpr double prompt_sample = 0.01;
constexpr double recent_echo = 0.3;
constexpr std::size_t silent_in_a_row = 8;
constexpr double rests_clear = 0.9;   // of its radius: it may have turned a little
constexpr double rests_radii = 0.25;  // between the places where a dead robot may stand

Limits limits_of(const Mission& mission) {
  return {mission.max_speed, mission.max_acceleration};
}
Limits limits_of(const RobotState& state) {
  return {state.max_speed, state.max_acceleration};
}

Commitment commitment_of(const RobotState& s, double clock_offset) {
  return {.stamp = s.stamp + clock_offset,
          .position = s.position,
          .velocity = s.velocity,
          .turn = s.promise.turn + clock_offset,
          .next_velocity = s.promise.velocity,
          .expiry = s.promise.expiry + clock_offset};
}

Commitment standing_for_ever_at(const Point2& position) {
  return {.position = position, .expiry = std::numeric_limits<double>::max()};
}

/// Until a robot stands that decides nothing more after this state.
double time_to_rest(const RobotState& s) {
  const int periods = braking_periods(s.promise.velocity.norm(), limits_of(s), control_period);
  return s.promise.expiry - s.stamp + periods * control_period;
}

bool wants_to_go_on(Phase phase) {
  return phase == Phase::planning || phase == Phase::driving;
}

}  // namespace

Fleet::Peer& Fleet::peer(const RobotName& robot) {
  // States of a period come in the same order as those of the period before, but for those who say nothing.
  for (std::size_t k = last_ + 1; k < std::min(peers_.size(), last_ + 1 + silent_in_a_row); ++k) {
    if (peers_[k].robot == robot) return peers_[last_ = k];
  }
  const auto [entry, fresh] = index_.try_emplace(robot, peers_.size());
  if (fresh) peers_.push_back({robot});
  last_ = entry->second;
  return peers_[last_];
}

void Fleet::hear(const Mission& mission, WallTime arrived) {
  if (!has_clock_ || mission.clock != clock_) {
    clock_ = mission.clock;
    has_clock_ = true;
    for (Peer& p : peers_) p.clock = {};
  }
  if (mission.robot == self_) {
    own_mission_ = mission;
    return;
  }
  Peer& p = peer(mission.robot);
  if (!p.mission && !p.state) p.heard_at = arrived;
  p.mission = mission;
}

bool Fleet::hear(std::shared_ptr<const RobotState> state, WallTime arrived) {
  if (state->robot == self_) return false;
  Peer& p = peer(state->robot);
  if (has_clock_) {
    const double now = clock_.fleet_time(arrived);
    p.clock.hear(state->stamp, now);
    // Nothing to learn from nearly all echoes: but a clock that was set shows in samples that seem late.
    const bool prompt = now - state->stamp < p.clock.estimate() + prompt_sample;
    const bool known = p.clock.error() < good_clock && prompt && now - own_echo_ < recent_echo;
    if (!known) hear_own_echo(*state, p.clock, now);
  }
  if (somebody_missing_) hear_of_the_missing(*state, clock_.fleet_time(arrived));
  // Best effort may reorder; a robot that was restarted begins its count anew, with a later stamp.
  if (p.state && state->stamp <= p.state->stamp) return false;
  if (p.state) loss_.hear(p.state->sequence, state->sequence);
  if (std::exchange(p.across, false)) minority_ = false;
  p.rests.clear();
  p.state = std::move(state);
  p.heard_at = arrived;
  return true;
}

void Fleet::hear_own_echo(const RobotState& state, ClockOffset& clock, double now) {
  for (const Echo& echo : state.echoes) {
    if (echo.robot != self_) continue;
    clock.hear_echo(echo.stamp, echo.received, now);
    own_echo_ = std::max(own_echo_, echo.stamp);
  }
}

/// What one has heard of another robot of late tells that this is alive.
void Fleet::hear_of_the_missing(const RobotState& state, double now) {
  for (const Echo& echo : state.echoes) {
    const auto known = index_.find(echo.robot);
    if (known == index_.end()) continue;
    Peer& p = peers_[known->second];
    const double newest = p.state ? std::max(p.echoed, p.state->stamp) : p.echoed;
    if (echo.stamp <= newest) continue;
    p.echoed = echo.stamp;
    p.echoed_at = now;
  }
}

bool Fleet::heard_elsewhere(const Peer& p, double now) const {
  return p.echoed_at > 0 && now - p.echoed_at < death * second();
}

bool Fleet::missing(const Peer& p, double seconds, double now) const {
  return p.state && !p.dead() && silence(p, now) > seconds * second();
}

Fleet::Absences Fleet::absences(double now) const {
  Absences count;
  for (const Peer& p : peers_) {
    const double silent = silence(p, now) / second();
    count.elsewhere += silent > long_absence && heard_elsewhere(p, now);
    if (p.dead()) {
      ++count.dead;
      continue;
    }
    if (!p.state) {
      count.never_came += p.mission && silent > absence;
      continue;
    }
    ++count.alive;
    count.unheard += silent > loneliness;
    count.absent += silent > absence;
    count.long_absent += silent > long_absence;
  }
  return count;
}

void Fleet::judge_silence(double now, const Point2& position, const ClearanceField& field) {
  const Absences count = absences(now);
  if (count.never_came + count.absent > 0) give_up_the_lost(count, now, position, field);
  say_more_often(count, now);
  somebody_missing_ = count.absent + count.never_came + count.dead > 0;
  const bool unheard_by_all = count.alive > 0 && own_echo_ > 0 && now - own_echo_ > long_absence * second();
  const bool alone = count.alive > 1 && count.unheard == count.alive;
  cut_off_ = minority_ || alone || unheard_by_all || count.long_absent > 1 || count.elsewhere > 0;
}

/// One that decides nothing more is dead once it must stand, too. If several are missing, all are dead when
/// the first is.
void Fleet::give_up_the_lost(const Absences& count, double now, const Point2& position,
                             const ClearanceField& field) {
  const double patience = count.absent > 1 ? longest_split : death;
  const bool over = std::ranges::any_of(peers_, [&](const Peer& p) {
    return missing(p, patience, now) && silence(p, now) > time_to_rest(*p.state) && !heard_elsewhere(p, now);
  });
  std::vector<Peer*> lost;
  for (Peer& p : peers_) {
    const bool never_came = !p.state && p.mission && silence(p, now) > longest_muster * second();
    const bool given_up = (never_came && !p.dead()) || (over && missing(p, absence, now));
    if (given_up && !heard_elsewhere(p, now)) lost.push_back(&p);
  }
  const std::size_t left = 1 + count.alive - count.absent;
  const bool minority = over && is_minority(lost, left);
  minority_ = minority_ || minority;
  const auto until_noticed = static_cast<int>(std::ceil(driven_cut_off * second() / control_period));
  const int unheard = count.absent > 1 ? until_noticed : loss_.unheard_states(left);
  for (Peer* p : lost) {
    p->across = minority;
    bury(*p, unheard, position, field, now);
  }
}

void Fleet::say_more_often(const Absences& count, double now) {
  if (count.alive == 0 || !loss_.notable() || loss_.unheard_states(count.alive) == 0) return;
  if (copies_ == most_copies || now - copies_since_ <= copies_tried) return;
  ++copies_;
  copies_since_ = now;
}

/// Of two pieces of equal size the one with the first name goes on. Of two robots both do.
bool Fleet::is_minority(std::span<Peer* const> lost, std::size_t left) const {
  if (lost.size() != left || left == 1) return lost.size() > left;
  return std::ranges::any_of(lost, [&](const Peer* other) {
    return other->robot < self_ && std::ranges::none_of(peers_, [&](const Peer& p) {
             return !p.dead() && std::ranges::find(lost, &p) == lost.end() && p.robot < other->robot;
           });
  });
}

/// Metres between the point and the nearest edge of a robot that is alive; this one is at `position`.
double Fleet::room_at(const Point2& q, const Point2& position, double now) const {
  double room = (q - position).norm() - own_mission_->radius;
  for (const Peer& p : peers_) {
    const bool known = p.state && !p.dead() && !missing(p, absence, now);
    if (known) room = std::min(room, (q - p.state->position).norm() - p.state->radius);
  }
  return room;
}

/// It stands where it braked to after the last decision that anybody may know of, and not in an obstacle or
/// in one of us.
void Fleet::bury(Peer& p, int unheard, const Point2& position, const ClearanceField& field, double now) {
  if (!p.state) {
    p.rests = {p.mission->start};
    return;
  }
  const RobotState& s = *p.state;
  p.rests = rests_after(commitment_of(s, 0), limits_of(s), control_period, unheard, rests_radii * s.radius);
  const auto impossible = std::find_if(p.rests.begin() + 1, p.rests.end(), [&](const Point2& q) {
    return !field.is_free(q, rests_clear * s.radius) || room_at(q, position, now) < s.radius + standing_gap;
  });
  p.rests.erase(impossible, p.rests.end());
}

void Fleet::add_neighbours(const Peer& p, std::vector<Neighbour>& near) const {
  const double radius = p.state ? p.state->radius : p.mission->radius;
  const Limits limits = p.state ? limits_of(*p.state) : limits_of(*p.mission);
  for (const Point2& rest : p.rests)
    near.push_back({.commitment = standing_for_ever_at(rest), .radius = radius, .limits = limits});
  if (p.dead()) return;
  if (p.state) {
    near.push_back({commitment_of(*p.state, p.clock.estimate()), radius, limits, p.clock.error()});
  } else {  // it stands where its mission begins
    near.push_back({standing_for_ever_at(p.mission->start), radius, limits});
  }
}

std::vector<Neighbour> Fleet::neighbours(const Point2& position, double reach, double horizon,
                                         double now) const {
  std::vector<Neighbour> near;
  near.reserve(peers_.size());
  for (const Peer& p : peers_) {
    if (!p.state && !p.mission) continue;
    if (p.state && !p.dead()) {
      const RobotState& s = *p.state;
      const double age = now - s.stamp - p.clock.estimate() + p.clock.error();
      const double braking = s.promise.expiry - s.stamp + s.max_speed / s.max_acceleration;
      const double far = reach + s.radius + s.max_speed * (age + std::max(horizon, braking));
      if ((s.position - position).squaredNorm() > far * far) continue;
    }
    add_neighbours(p, near);
  }
  return near;
}

FleetMember Fleet::member(const Peer& p) const {
  if (!p.state) {
    return {.robot = p.robot,
            .position = p.mission->start,
            .goal = p.mission->start,
            .radius = p.mission->radius,
            .dead = p.dead(),
            .knot = {}};
  }
  const RobotState& s = *p.state;
  const Point2 position = p.dead() ? p.rests.front() : s.position;
  return {.robot = p.robot,
          .position = position,
          .velocity = p.dead() ? Point2::Zero() : s.velocity,
          .goal = !p.dead() && p.mission && wants_to_go_on(s.phase) ? p.mission->goal : position,
          .radius = s.radius,
          .stands = s.velocity.isZero(0) && s.promise.velocity.isZero(0),
          .dead = p.dead(),
          .parked = !p.dead() && !wants_to_go_on(s.phase),
          .knot = s.knot,
          .stage = s.stage,
          .progress = s.progress};
}

std::vector<Disc> Fleet::places_of_the_dead(const Point2& position, double now) const {
  std::vector<Disc> places;
  for (const Peer& p : peers_) {
    const double radius = p.state ? p.state->radius : p.mission ? p.mission->radius : 0;
    for (const Point2& rest : p.rests) {
      // Somebody may have come there since, who took it to stand elsewhere, and is the proof of it. One that
      // stands closer than a plan would lead it must get away again.
      const double room = room_at(rest, position, now);
      if (rest == p.rests.front() || room >= radius)
        places.push_back({rest, std::clamp(room - standing_gap, 0.0, radius)});
    }
  }
  return places;
}

std::optional<FleetMember> Fleet::find(const RobotName& robot) const {
  const auto known = index_.find(robot);
  if (known == index_.end()) return std::nullopt;
  return member(peers_[known->second]);
}

std::vector<FleetMember> Fleet::others() const {
  std::vector<FleetMember> all;
  for (const Peer& p : peers_) all.push_back(member(p));
  return all;
}

bool Fleet::all_hold(const KnotId& knot) const {
  return std::ranges::all_of(peers_, [&](const Peer& p) {
    const FleetMember m = member(p);
    if (m.dead || m.knot.overrides(knot)) return true;
    if (m.knot != knot && !knot.includes(m.position)) return true;
    return m.stands && m.stage == Stage::holding && m.knot == knot;
  });
}

bool Fleet::all_free(const Point2& p, double reach) const {
  return std::ranges::all_of(peers_, [&](const Peer& peer) {
    const bool far = peer.state && (peer.state->position - p).norm() > reach;
    return !peer.state || peer.state->stage == Stage::free || far || peer.dead();
  });
}

double Fleet::crowd(const Point2& p, double near) const {
  std::vector<Point2> outside;
  for (const Peer& peer : peers_) {
    if (!peer.dead()) outside.push_back(member(peer).position);
  }
  double reach = near;
  std::vector<Point2> open{p};
  while (!open.empty()) {
    const Point2 here = open.back();
    open.pop_back();
    const auto joined =
        std::ranges::partition(outside, [&](const Point2& q) { return (q - here).norm() > near; });
    for (const Point2& q : joined) reach = std::max(reach, (q - p).norm() + near / 2);
    open.insert(open.end(), joined.begin(), joined.end());
    outside.erase(joined.begin(), joined.end());
  }
  return reach;
}

double Fleet::clock_error() const {
  double most = 0;
  for (const Peer& p : peers_) {
    if (p.clock.known() && !p.dead()) most = std::max(most, p.clock.error());
  }
  return most;
}

bool Fleet::somebody_plans() const {
  return std::ranges::any_of(peers_,
                             [](const Peer& p) { return p.state && p.state->phase == Phase::planning; });
}

bool Fleet::complete(std::size_t robots) const {
  return peers_.size() + 1 >= robots && std::ranges::all_of(peers_, [&](const Peer& p) {
           const bool done = p.mission && p.mission->cancelled;
           return done || (p.state && p.clock.known()) || p.dead();
         });
}

std::vector<Echo> Fleet::next_echoes() {
  std::vector<Echo> echoes;
  for (std::size_t k = 0; k < std::min(echoes_a_state, peers_.size()); ++k) {
    const Peer& p = peers_[next_echo_++ % peers_.size()];
    if (p.state) echoes.push_back({p.robot, p.state->stamp, clock_.fleet_time(p.heard_at)});
  }
  return echoes;
}

std::vector<RobotState> Fleet::last_words(double now) const {
  std::vector<RobotState> states;
  for (const Peer& p : peers_) {
    const double silent = silence(p, now) / second();
    if (p.state && silent > relay_from && silent < relay_until) states.push_back(*p.state);
  }
  return states;
}

}  // namespace coppice
