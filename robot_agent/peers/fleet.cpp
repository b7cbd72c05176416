#include "robot_agent/peers/fleet.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "planning/quantities.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

Promise standing_for_ever_at(const Point2& position) {
  return {.position = position, .expiry = std::numeric_limits<double>::max()};
}

bool wants_to_go_on(Phase phase) {
  return phase == Phase::planning || phase == Phase::driving;
}

}  // namespace

Peer& Fleet::peer(const RobotName& robot) {
  const auto [number, is_new] = peers_.find_or_add(robot);
  if (is_new) {
    detector_.count_again();
    all_known_ = false;
  }
  return peers_[number];
}

void Fleet::hear(const Mission& mission, WallTime arrived) {
  if (own_.run_clock != mission.clock) {
    own_.run_clock = mission.clock;
    forget_other_runs();
  }
  size_of_the_run_ = mission.fleet_size;
  longest_braking_ = std::max(longest_braking_, braking_time(limits_of(mission)));
  if (mission.robot == own_.name) {
    own_.mission = mission;
    return;
  }
  if (!peers_.has_room_for(mission.robot)) return;
  Peer& p = peer(mission.robot);
  if (!p.mission && !p.state) p.heard_at = arrived;
  if (!p.state) {
    p.radius = mission.radius;
    p.max_speed = mission.max_speed;
    if (!p.failed()) p.place = mission.start;
  }
  new_goals_ += p.mission && p.mission->number != mission.number;
  p.mission = std::make_unique<const Mission>(mission);
}

/// Robots of which only another run is known may not be in this one at all.
void Fleet::forget_other_runs() {
  dissemination_.forget_peers();
  detector_.forget_peers();
  all_known_ = false;
  for (Peer& p : peers_.take_all()) {
    if (!p.state || !is_of_run(*p.state, own_.clock().run())) continue;
    p.clock = {};
    p.has_heard = 0;
    p.exchange.handshakes = 0;
    detector_.keep(p);
    Peer& kept = peer(p.robot);
    kept = std::move(p);
  }
}

inline void Fleet::compare_clocks(const RobotState& state, Peer& p, double now) {
  p.clock.hear(state.promise.stamp, now);
  // Nearly all echoes tell nothing new. But a clock that was set shows in states that seem late.
  const bool prompt = now - state.promise.stamp < p.clock.estimate() + Timing::prompt_sample;
  const bool known = p.clock.error(now) < Timing::good_clock && prompt && echoed(now) && !may_be_unknown();
  if (!known) detector_.hear_own_echoes(state, p, now);
}

inline void Fleet::take_up(std::shared_ptr<const RobotState>&& state, std::size_t number, double now) {
  Peer& p = peers_[number];
  if (detector_.hear(p, *state, now)) all_known_ = false;
  if (state->is_new) p.exchange.handshakes = 0;
  if (p.state && p.state->phase == Phase::halted && state->phase != Phase::halted) ++released_;
  p.state = std::move(state);
  p.place = p.state->promise.position;
  p.radius = p.state->radius;
  p.max_speed = p.state->max_speed;
  dissemination_.hear(number, now);
  peers_.away_until[number] = 0;
}

bool Fleet::hear(std::shared_ptr<const RobotState> state, WallTime arrived) {
  if (state->robot == own_.name || !peers_.has_room_for(state->robot)) return false;
  // Its times would be those of the run before.
  if (own_.run_clock && !is_of_run(*state, own_.run_clock->run())) return false;
  Peer& p = peer(state->robot);
  const double now = own_.clock().fleet_time(arrived);
  if (state->passed_on && is_untrustworthy(*state, p, now)) return false;
  if (own_.run_clock) compare_clocks(*state, p, now);
  if (is_overslept(*state, p)) return false;
  if (detector_.somebody_missing()) detector_.hear_of_missing(*state, p, now);
  if (state->copy == 0 && !state->passed_on) dissemination_.count_loss(p, state->sequence);
  // Best effort may reorder. A robot that was restarted begins its count anew, with a later stamp.
  if (p.state && state->promise.stamp <= p.state->promise.stamp) {
    if (state->promise.stamp == p.state->promise.stamp && state->passed_on) detector_.hear_relay(p, arrived);
    return false;
  }
  take_up(std::move(state), peers_.number_of(p), now);
  p.heard_at = arrived;
  return true;
}

void Fleet::begin_anew(std::span<const Heard> silent, double now) {
  own_.began_in_mid_run = true;
  detector_.begin_anew(now);
  for (const Heard& last : silent)
    hear(std::make_shared<const RobotState>(last.state), own_.clock().wall_time(last.at));
}

void Fleet::wake(double now) {
  begin_anew({}, now);
  own_.woke_at = now;
  detector_.count_again();
  all_known_ = false;
  for (Peer& p : peers_) {
    if (!p.alive() && p.suspicion() == nullptr) continue;
    p.state.reset();
    p.liveness = liveness::Expected{};
    p.relayed.reset();
    p.elsewhere = {};
  }
}

/// It came while the process slept, and was read only afterwards. What others say of a failed peer holds.
bool Fleet::is_overslept(const RobotState& state, const Peer& p) const {
  return own_.woke_at && !state.counts_as_failed && p.clock.known() &&
         state.promise.stamp + p.clock.estimate() + p.clock.error(*own_.woke_at) < *own_.woke_at;
}

void Fleet::expect(const RobotName& robot) const {
  const auto known = peers_.find(robot);
  if (!known) return;
  const Peer& p = peers_[*known];
  __builtin_prefetch(&p.state);
  __builtin_prefetch(&p.clock);
}

/// Others may relay what they like of a peer. A state from the future is not believed; nor is one that is
/// newer than the last state of a peer that is heard itself. It will be relayed again.
bool Fleet::is_untrustworthy(const RobotState& relayed, const Peer& p, double now) const {
  if (!own_.run_clock) return false;
  const bool is_heard =
      p.alive() && !p.state->passed_on && own_.since(p.heard_at, now) < Timing::relay_from * own_.second();
  return own_.is_from_the_future(relayed.promise.stamp, p, now) ||
         (is_heard && relayed.promise.stamp > p.state->promise.stamp);
}

void Fleet::detect_failures(double now, const Point2& position, const RoundId& waits_in,
                            const ClearanceField& field) {
  own_.position = position;
  own_.wait_in(waits_in, peers_);
  detector_.judge(now, field, dissemination_.loss());
  dissemination_.choose_copies(detector_.alive());
}

std::optional<RobotName> Fleet::heard_by_others_only() const {
  const auto number = detector_.heard_by_others_only();
  return number ? std::optional(peers_[*number].robot) : std::nullopt;
}

/// The largest error of the peer's clock until the robot stands, if it decides something now: clocks drift
/// meanwhile.
double Fleet::error_in_window(const Peer& p, double now) const {
  const double window = own_.mission ? braking_time(limits_of(*own_.mission)) + 3 * control_period : 0;
  return p.clock.error(now + window);
}

void Fleet::add_neighbours(const Peer& p, const Point2& position, double now,
                           std::vector<Neighbour>& near) const {
  const Limits limits = p.state ? limits_of(*p.state) : limits_of(*p.mission);
  if (const Suspicion* const s = p.suspicion(); s != nullptr && now < s->until) {
    near.push_back({standing_for_ever_at(p.place), p.radius + s->strays, limits, 0, true});
  } else if (const Failure* const failure = p.failure()) {
    const double covers = covering_radius(failure->zone, p.radius, own_.mission->radius);
    for (const Point2& rest : failure->zone.rests) {
      const double room = (rest - position).norm() - own_.mission->radius - standing_gap;
      near.push_back({standing_for_ever_at(rest), std::clamp(room, p.radius, covers), limits});
    }
  } else if (p.state) {
    near.push_back(
        {p.state->promise.shifted_by(p.clock.estimate()), p.radius, limits, error_in_window(p, now)});
  } else {  // it stands where its mission begins
    near.push_back({standing_for_ever_at(p.place), p.radius, limits});
  }
}

/// Within about a second: the peer sends at least as often as a robot that stands.
bool Fleet::may_be_touched_soon(const Peer& p) const {
  return send_interval(own_.gap(p), own_.closing_speed(p)) <= heartbeat_interval;
}

void Fleet::collect_neighbours(const Point2& position, double reach, double horizon, double now,
                               AgeCount& ages, std::vector<Neighbour>& near,
                               const std::function<bool(const RobotState&, double)>& passes) {
  near.clear();
  for (std::size_t k = 0; k < peers_.size(); ++k) {
    if (now < peers_.away_until[k]) continue;
    const Peer& p = peers_[k];
    if (p.alive()) {
      const RobotState& s = *p.state;
      const double age = now - s.promise.stamp - p.clock.estimate() + p.clock.error(now);
      const double braking = s.promise.expiry - s.promise.stamp + braking_time(limits_of(s));
      const double far = reach + s.radius + s.max_speed * (age + std::max(horizon, braking));
      const double distance = (s.promise.position - position).norm();
      if (distance > far) {
        peers_.away_until[k] = now + (distance - far) / own_.closing_speed(p);
        continue;
      }
      if (p.clock.known() && may_be_touched_soon(p)) ages.add(now - s.promise.stamp - p.clock.estimate());
      if (passes && passes(s, age)) continue;
    }
    add_neighbours(p, position, now, near);
  }
}

FleetMember Fleet::member(const Peer& p, double now) const {
  if (!p.state) {
    return {.robot = p.robot,
            .position = p.place,
            .goal = p.place,
            .radius = p.radius,
            .max_speed = p.max_speed,
            .failed = p.failed(),
            .round = {},
            .waits_for = {}};
  }
  const RobotState& s = *p.state;
  const bool stands = s.promise.stands();
  const Mission* const mission = p.failed() ? nullptr : p.mission.get();
  const bool has_given_up = has_no_way(s.phase);
  return {
      .robot = p.robot,
      .position = p.place,
      .velocity = p.failed() ? Point2::Zero() : s.promise.velocity,
      .goal = has_given_up ? std::nullopt : std::optional(mission ? mission->goal : p.place),
      .arrives_within = mission ? arrives_within(*mission) : 0,
      .wants_to_stay = !wants_to_go_on(s.phase),
      .radius = s.radius,
      .max_speed = s.max_speed,
      .rests_until = stands ? s.promise.expiry + p.clock.estimate() : s.promise.stamp + p.clock.estimate(),
      .stands = stands,
      .failed = p.failed(),
      .takes_no_part = s.phase == Phase::stopped || s.phase == Phase::halted ||
                       ((s.is_new || p.exchange.misses_somebody) && has_given_up),
      .round = s.round,
      .stage = s.stage,
      .reservation = s.reservation,
      .reservation_progress = s.reservation_progress,
      .waits_for = s.waits_for,
      .promise = s.promise.shifted_by(p.clock.estimate()),
      .limits = limits_of(s),
      .clock_offset = p.clock.estimate(),
      .clock_error = error_in_window(p, now)};
}

std::vector<Disc> Fleet::zones_of_failed(const Point2& position, double now) const {
  constexpr double whenever = -std::numeric_limits<double>::infinity();
  std::vector<Disc> zones;
  for (const Peer& p : peers_) {
    const Failure* const failure = p.failure();
    if (failure == nullptr) continue;
    const double covers = covering_radius(failure->zone, p.radius, own_.mission->radius);
    for (const Point2& rest : failure->zone.rests) {
      // A robot that stands closer than a plan would lead it must get away again.
      const double room = detector_.room_at(rest, position, whenever, now) - standing_gap;
      zones.push_back({rest, std::clamp(room, 0.0, covers)});
    }
  }
  return zones;
}

std::optional<FleetMember> Fleet::find(const RobotName& robot, double now) const {
  const auto known = peers_.find(robot);
  return known ? std::optional(member(peers_[*known], now)) : std::nullopt;
}

std::vector<FleetMember> Fleet::others() const {
  std::vector<FleetMember> all;
  for (const Peer& p : peers_) all.push_back(member(p));
  return all;
}

double Fleet::longest_stop() const {
  constexpr double between_states = 2;  // peers come closer, and speed up, until they are heard again
  const Limits limits = limits_of(*own_.mission);
  double longest = 0;
  for (const Peer& peer : peers_) {
    if (peer.failed() || !peer.state) continue;
    const double speed = peer.state->promise.next_velocity.norm();
    const double stop = speed / peer.state->max_acceleration;
    const double reach = std::min(limits.max_speed, limits.max_acceleration * stop) * stop;
    if (own_.gap(peer) < between_states * (speed * stop + reach)) longest = std::max(longest, stop);
  }
  return longest;
}

std::vector<FleetMember> Fleet::beside(const Point2& p, double radius, double sums, double now) const {
  std::vector<FleetMember> close;
  for (const Peer& peer : peers_) {
    if ((peer.place - p).norm() <= sums * (radius + peer.radius)) close.push_back(member(peer, now));
  }
  return close;
}

bool Fleet::all_wait(const RoundId& round) const {
  return std::ranges::all_of(peers_, [&](const Peer& p) {
    const FleetMember m = member(p);
    if (m.failed || m.round.overrides(round)) return true;
    if (m.takes_no_part) return m.stands;
    if (m.round != round && !round.includes(m.position)) return true;
    return m.stands && m.stage == Stage::waiting && m.round == round;
  });
}

bool Fleet::all_free(const Point2& p, double reach) const {
  return std::ranges::all_of(peers_, [&](const Peer& peer) {
    const bool far = (peer.place - p).norm() > reach;
    return far || peer.failed() || !peer.state || peer.state->stage == Stage::free;
  });
}

bool Fleet::is_awaited(const Point2& p, double reach) const {
  return std::ranges::any_of(peers_, [&](const Peer& peer) {
    const bool near = (peer.place - p).norm() <= reach;
    return near && !peer.failed() && peer.state && peer.state->waits_for == own_.name;
  });
}

bool Fleet::nobody_waits(const Point2& p, double reach) const {
  return std::ranges::none_of(peers_, [&](const Peer& peer) {
    const bool near = (peer.place - p).norm() <= reach;
    return near && !peer.failed() && peer.state && peer.state->stage == Stage::waiting;
  });
}

double Fleet::cluster_reach(const Point2& p, const Path& way, double near) const {
  std::vector<Point2> outside;
  std::vector<Point2> open{p};
  double reach = near;
  for (const Peer& peer : peers_) {
    if (peer.failed()) continue;
    const FleetMember m = member(peer);
    const bool may_block = m.stands && !m.wants_to_stay && m.reservation == 0;
    const bool is_in_the_way =
        may_block && point_path_distance(m.position, way) < own_.mission->radius + m.radius;
    (is_in_the_way ? open : outside).push_back(peer.place);
    if (is_in_the_way) reach = std::max(reach, (m.position - p).norm() + near / 2);
  }
  while (!open.empty()) {
    const Point2 here = open.back();
    open.pop_back();
    const auto joined = std::partition(outside.begin(), outside.end(),
                                       [&](const Point2& q) { return (q - here).norm() > near; });
    for (auto q = joined; q != outside.end(); ++q) reach = std::max(reach, (*q - p).norm() + near / 2);
    open.insert(open.end(), joined, outside.end());
    outside.erase(joined, outside.end());
  }
  return reach;
}

double Fleet::nearest(const Point2& p) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Peer& peer : peers_) least = std::min(least, (peer.place - p).norm());
  return least;
}

bool Fleet::somebody_plans() const {
  return std::ranges::any_of(peers_,
                             [](const Peer& p) { return p.state && p.state->phase == Phase::planning; });
}

bool Fleet::run_is_over() const {
  return own_.mission && own_.mission->cancelled &&
         std::ranges::all_of(peers_, [](const Peer& p) { return !p.mission || p.mission->cancelled; });
}

std::vector<RobotName> Fleet::robots_of_the_run() const {
  std::vector<RobotName> robots;
  if (own_.mission && !own_.mission->cancelled) robots.push_back(own_.name);
  for (const Peer& p : peers_) {
    if (p.mission && !p.mission->cancelled) robots.push_back(p.robot);
  }
  return robots;
}

/// A peer that never came is at its start. But a process that began in mid-run does not know what was before.
bool Fleet::is_known(const Peer& p) const {
  const bool done = p.mission && p.mission->cancelled && (p.state || !own_.began_in_mid_run);
  return done || (p.state && p.clock.known()) || p.failed();
}

RobotName Fleet::unknown() const {
  const auto unknown = std::ranges::find_if_not(peers_, [&](const Peer& p) { return is_known(p); });
  return unknown == peers_.end() ? RobotName() : unknown->robot;
}

bool Fleet::is_placed(const RobotName& robot) const {
  const auto number = peers_.find(robot);
  return number && !peers_[*number].expected();
}

std::vector<RobotName> Fleet::missing() const {
  std::vector<RobotName> robots;
  for (const std::size_t number : detector_.missing()) robots.push_back(peers_[number].robot);
  return robots;
}

bool Fleet::complete() {
  all_known_ = all_known_ || std::ranges::all_of(peers_, [&](const Peer& p) { return is_known(p); });
  return all_known_ && has_missions();
}

}  // namespace coppice
