#include "robot_agent/fleet.h"

#include <algorithm>
#include <limits>

namespace coppice {

namespace {

// Seconds of the wall's clock without a state after which a robot counts as dead: far longer than a pause of
// a process or a run of lost samples lasts, for one that drives on unheard may touch those who think it dead.
constexpr double death = 2;
// The same for one that was never heard of: its process may still have to start.
constexpr double longest_muster = 10;
// Who falls silent may have sent states that only some have heard: in this time they are passed on.
constexpr double relay_from = 0.3;
constexpr double relay_until = 4;
constexpr std::size_t echoes_a_state = 4;

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
  // States of a period come in the same order as those of the period before.
  if (++last_ < peers_.size() && peers_[last_].robot == robot) return peers_[last_];
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
    for (const Echo& echo : state->echoes) {
      if (echo.robot == self_) p.clock.hear_echo(echo.stamp, echo.received, now);
    }
  }
  // Best effort may reorder; a robot that was restarted begins its count anew, with a later stamp.
  if (p.state && state->stamp <= p.state->stamp) return false;
  p.state = std::move(state);
  p.heard_at = arrived;
  return true;
}

/// One that decides nothing more is dead once it must stand, too.
bool Fleet::dead(const Peer& p, double now) const {
  const double silent = silence(p, now);
  if (!p.state) return silent > longest_muster * clock_.scale;
  return silent > death * clock_.scale && silent > time_to_rest(*p.state);
}

Neighbour Fleet::neighbour(const Peer& p, bool is_dead) const {
  if (!p.state) {  // it stands where its mission begins
    return {.commitment = standing_for_ever_at(p.mission->start),
            .radius = p.mission->radius,
            .limits = limits_of(*p.mission)};
  }
  const RobotState& s = *p.state;
  Neighbour n{.radius = s.radius, .limits = limits_of(s)};
  if (is_dead) {
    n.commitment = standing_for_ever_at(rest_after(commitment_of(s, 0), n.limits, control_period));
  } else {
    n.commitment = commitment_of(s, p.clock.estimate());
    n.clock_error = p.clock.error();
  }
  return n;
}

std::vector<Neighbour> Fleet::neighbours(const Point2& position, double reach, double horizon,
                                         double now) const {
  std::vector<Neighbour> near;
  near.reserve(peers_.size());
  for (const Peer& p : peers_) {
    if (!p.state && !p.mission) continue;
    if (p.state) {
      const RobotState& s = *p.state;
      const double age = now - s.stamp - p.clock.estimate() + p.clock.error();
      const double braking = s.promise.expiry - s.stamp + s.max_speed / s.max_acceleration;
      const double far = reach + s.radius + s.max_speed * (age + std::max(horizon, braking));
      if ((s.position - position).squaredNorm() > far * far) continue;
    }
    near.push_back(neighbour(p, dead(p, now)));
  }
  return near;
}

FleetMember Fleet::member(const Peer& p, double now) const {
  const bool is_dead = dead(p, now);
  if (!p.state) {
    return {.robot = p.robot,
            .position = p.mission->start,
            .goal = p.mission->start,
            .radius = p.mission->radius,
            .dead = is_dead,
            .knot = {}};
  }
  const RobotState& s = *p.state;
  const Point2 position =
      is_dead ? rest_after(commitment_of(s, 0), limits_of(s), control_period) : s.position;
  return {.robot = p.robot,
          .position = position,
          .velocity = is_dead ? Point2::Zero() : s.velocity,
          .goal = !is_dead && p.mission && wants_to_go_on(s.phase) ? p.mission->goal : position,
          .radius = s.radius,
          .stands = s.velocity.isZero(0) && s.promise.velocity.isZero(0),
          .dead = is_dead,
          .parked = !is_dead && !wants_to_go_on(s.phase),
          .knot = s.knot,
          .stage = s.stage,
          .progress = s.progress};
}

std::optional<FleetMember> Fleet::find(const RobotName& robot, double now) const {
  const auto known = index_.find(robot);
  if (known == index_.end()) return std::nullopt;
  return member(peers_[known->second], now);
}

std::vector<FleetMember> Fleet::others(double now) const {
  std::vector<FleetMember> all;
  for (const Peer& p : peers_) all.push_back(member(p, now));
  return all;
}

bool Fleet::all_hold(const KnotId& knot, double now) const {
  return std::ranges::all_of(peers_, [&](const Peer& p) {
    const FleetMember m = member(p, now);
    if (m.dead || m.knot.overrides(knot)) return true;
    if (m.knot != knot && !knot.includes(m.position)) return true;
    return m.stands && m.stage == Stage::holding && m.knot == knot;
  });
}

bool Fleet::all_free(const Point2& p, double reach, double now) const {
  return std::ranges::all_of(peers_, [&](const Peer& peer) {
    const bool far = peer.state && (peer.state->position - p).norm() > reach;
    return !peer.state || peer.state->stage == Stage::free || far || dead(peer, now);
  });
}

double Fleet::crowd(const Point2& p, double near, double now) const {
  std::vector<Point2> outside;
  for (const Peer& peer : peers_) {
    if (!dead(peer, now)) outside.push_back(member(peer, now).position);
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

double Fleet::clock_error(double now) const {
  double most = 0;
  for (const Peer& p : peers_) {
    if (p.clock.known() && !dead(p, now)) most = std::max(most, p.clock.error());
  }
  return most;
}

bool Fleet::somebody_plans() const {
  return std::ranges::any_of(peers_,
                             [](const Peer& p) { return p.state && p.state->phase == Phase::planning; });
}

bool Fleet::complete(std::size_t robots, double now) const {
  return peers_.size() + 1 >= robots && std::ranges::all_of(peers_, [&](const Peer& p) {
           const bool done = p.mission && p.mission->cancelled;
           return done || (p.state && p.clock.known()) || dead(p, now);
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
    const double silent = silence(p, now) / clock_.scale;
    if (p.state && silent > relay_from && silent < relay_until) states.push_back(*p.state);
  }
  return states;
}

}  // namespace coppice
