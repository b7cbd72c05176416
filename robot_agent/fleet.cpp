#include "robot_agent/fleet.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "planning/quantities.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

constexpr double good_clock = 0.003;    // seconds: six centimetres' drive
constexpr double prompt_sample = 0.01;  // seconds
constexpr double set_clock = 60;        // seconds: clocks are not set by more while a fleet drives
constexpr double recent_echo = 0.8;     // seconds: less than it takes a robot to think that nobody hears it

Commitment standing_for_ever_at(const Point2& position) {
  return {.position = position, .expiry = std::numeric_limits<double>::max()};
}

bool wants_to_go_on(Phase phase) {
  return phase == Phase::planning || phase == Phase::driving;
}

}  // namespace

std::size_t Fleet::number_of(const RobotName& robot) {
  const auto [number, fresh] = index_.insert(robot);
  if (fresh) {
    peers_.push_back({.phase = phase_of(robot), .robot = robot});
    away_until_.push_back(0);
    told_from_.push_back(0);
    answered_until_.push_back(0);
    all_settled_until_ = 0;
    all_known_ = false;
  }
  return number;
}

void Fleet::hear(const Mission& mission, WallTime arrived) {
  if (!has_clock_ || mission.clock != clock_) {
    clock_ = mission.clock;
    has_clock_ = true;
    forget_other_runs();
  }
  size_of_the_run_ = mission.fleet_size;
  if (mission.robot == self_) {
    own_mission_ = mission;
    return;
  }
  if (!has_room_for(mission.robot)) return;
  Peer& p = peers_[number_of(mission.robot)];
  if (!p.mission && !p.state) p.heard_at = arrived;
  if (!p.state) {
    p.radius = mission.radius;
    p.max_speed = mission.max_speed;
    if (!p.failed) p.place = mission.start;
  }
  new_goals_ += p.mission && p.mission->number != mission.number;
  p.mission = std::make_unique<const Mission>(mission);
}

/// Robots of which only another run is known may not be in this one at all.
void Fleet::forget_other_runs() {
  std::vector<Peer> heard = std::exchange(peers_, {});
  index_ = {};
  away_until_.clear();
  told_from_.clear();
  answered_until_.clear();
  next_echo_ = chosen_among_ = 0;
  missing_.clear();
  silent_failed_.clear();
  missed_by_others_.clear();
  all_known_ = false;
  somebody_new_at_ = somebody_back_at_ = long_ago;
  for (Peer& p : heard) {
    if (!p.state || p.state->run != clock_.epoch) continue;
    p.clock = {};
    p.handshakes = 0;
    if (p.state->is_new) somebody_new_at_ = std::max(somebody_new_at_, clock_.fleet_time(p.heard_at));
    peers_[number_of(p.robot)] = std::move(p);
  }
}

bool Fleet::hear(std::shared_ptr<const RobotState> state, WallTime arrived) {
  if (state->robot == self_ || !has_room_for(state->robot)) return false;
  // Its times would be those of the run before.
  if (has_clock_ && state->run != clock_.epoch) return false;
  const std::size_t number = number_of(state->robot);
  Peer& p = peers_[number];
  if (state->passed_on && is_untrustworthy(*state, p, arrived)) return false;
  if (has_clock_) {
    const double now = clock_.fleet_time(arrived);
    p.clock.hear(state->stamp, now);
    // Nothing to learn from nearly all echoes: but a clock that was set shows in samples that seem late.
    const bool prompt = now - state->stamp < p.clock.estimate() + prompt_sample;
    const bool known = p.clock.error(now) < good_clock && prompt && echoed(now);
    if (!known) hear_own_echo(*state, p.clock, now);
  }
  if (somebody_missing_) hear_of_the_missing(*state, p, clock_.fleet_time(arrived));
  if (state->copy == 0 && !state->passed_on) {
    const Received::Count count = p.received.hear(state->sequence);
    if (count.sent > 0 && own_mission_ && tells_at_every_heartbeat(p)) loss_.add(count);
  }
  // Best effort may reorder; a robot that was restarted begins its count anew, with a later stamp.
  if (p.state && state->stamp <= p.state->stamp) {
    if (state->stamp == p.state->stamp && state->passed_on) hear_again(p, arrived);
    return false;
  }
  if (std::exchange(p.across, false)) minority_until_ = 0;
  if (const double now = clock_.fleet_time(arrived); own_mission_ && !state->passed_on && was_away(p, now))
    p.back_at = somebody_back_at_ = now;
  p.reported_failed = !p.state && state->counts_as_failed;
  failure_reported_ = failure_reported_ || p.reported_failed;
  if (state->is_new) {
    p.handshakes = 0;
    if (has_clock_) somebody_new_at_ = clock_.fleet_time(arrived);
  }
  if (!p.state || p.failed) all_settled_until_ = 0;
  if (std::exchange(p.failed, false)) {
    all_known_ = false;
    p.rests.clear();
    p.suspected_until = 0;
    ++recoveries_;
  }
  p.state = std::move(state);
  p.place = p.state->position;
  p.radius = p.state->radius;
  p.max_speed = p.state->max_speed;
  if (answers(*p.state, number, clock_.fleet_time(arrived)) || p.state->wants_echo) p.asks = true;
  p.waits_for_this = p.state->waits_for == self_;
  p.heard_at = arrived;
  p.said_again = false;
  p.interval_until = 0;
  away_until_[number] = 0;
  told_from_[number] = 0;
  return true;
}

void Fleet::begin_anew(std::span<const Heard> silent, double now) {
  begun_anew_ = true;
  somebody_back_at_ = now;
  for (const Heard& last : silent)
    hear(std::make_shared<const RobotState>(last.state), clock_.wall_time(last.at));
}

void Fleet::expect(const RobotName& robot) const {
  const auto known = index_.find(robot);
  if (!known) return;
  const Peer& p = peers_[*known];
  __builtin_prefetch(&p.state);
  __builtin_prefetch(&p.clock);
}

/// New names cost memory and time for ever: past what a fleet may be, they are nobody's.
bool Fleet::has_room_for(const RobotName& robot) const {
  return peers_.size() < most_robots || index_.find(robot).has_value();
}

/// Others may pass on what they like of a robot: nothing from its future, and not that it has said something
/// newer where it is heard itself. It is passed on again.
bool Fleet::is_untrustworthy(const RobotState& passed_on, const Peer& p, WallTime arrived) const {
  if (!has_clock_) return false;
  const double now = clock_.fleet_time(arrived);
  const bool heard_itself =
      p.state && !p.state->passed_on && !p.failed && since(p.heard_at, now) < relay_from * second();
  return is_from_the_future(passed_on.stamp, p, now) || (heard_itself && passed_on.stamp > p.state->stamp);
}

/// By far: later than it can be by the other's clock, even if that was set a little.
bool Fleet::is_from_the_future(double stamp, const Peer& p, double now) const {
  return p.clock.known() &&
         stamp > now - p.clock.estimate() + p.clock.error(now) + set_clock * std::max(1.0, clock_.scale);
}

bool Fleet::echoed(double now) const {
  return now - own_echo_ < recent_echo * second();
}

void Fleet::hear_own_echo(const RobotState& state, ClockOffset& clock, double now) {
  for (const Echo& echo : state.echoes) {
    if (echo.robot != self_ || echo.stamp > now) continue;  // nobody has heard what is still to be said
    clock.hear_echo(echo.stamp, echo.received, now);
    own_echo_ = std::max(own_echo_, echo.stamp);
  }
}

void Fleet::add_neighbours(const Peer& p, const Point2& position, double now,
                           std::vector<Neighbour>& near) const {
  const Limits limits = p.state ? limits_of(*p.state) : limits_of(*p.mission);
  if (p.failed && now < p.suspected_until) {
    near.push_back({standing_for_ever_at(p.place), p.radius + p.strays, limits, 0, true});
  } else if (p.failed) {
    const double covers = covers_rests(p);
    for (const Point2& rest : p.rests) {
      const double room = (rest - position).norm() - own_mission_->radius - standing_gap;
      near.push_back({standing_for_ever_at(rest), std::clamp(room, p.radius, covers), limits});
    }
  } else if (p.state) {
    near.push_back({commitment_of(*p.state, p.clock.estimate()), p.radius, limits, p.clock.error(now)});
  } else {  // it stands where its mission begins
    near.push_back({standing_for_ever_at(p.place), p.radius, limits});
  }
}

/// Within about a second: it says something as often as one that stands, or more often.
bool Fleet::may_be_touched_soon(const Peer& p) const {
  return send_interval(gap(p), closing_speed(p)) <= heartbeat_interval;
}

void Fleet::collect_neighbours(const Point2& position, double reach, double horizon, double now,
                               AgeCount& ages, std::vector<Neighbour>& near) {
  near.clear();
  for (std::size_t k = 0; k < peers_.size(); ++k) {
    if (now < away_until_[k]) continue;
    const Peer& p = peers_[k];
    if (p.state && !p.failed) {
      const RobotState& s = *p.state;
      const double age = now - s.stamp - p.clock.estimate() + p.clock.error(now);
      const double braking = s.promise.expiry - s.stamp + s.max_speed / s.max_acceleration;
      const double far = reach + s.radius + s.max_speed * (age + std::max(horizon, braking));
      const double distance = (s.position - position).norm();
      if (distance > far) {
        away_until_[k] = now + (distance - far) / closing_speed(p);
        continue;
      }
      if (p.clock.known() && may_be_touched_soon(p)) ages.add(now - s.stamp - p.clock.estimate());
    }
    add_neighbours(p, position, now, near);
  }
}

FleetMember Fleet::member(const Peer& p) const {
  if (!p.state) {
    return {.robot = p.robot,
            .position = p.place,
            .goal = p.place,
            .radius = p.radius,
            .max_speed = p.max_speed,
            .failed = p.failed,
            .round = {}};
  }
  const RobotState& s = *p.state;
  const bool stands = s.velocity.isZero(0) && s.promise.velocity.isZero(0);
  const Mission* const mission = p.failed ? nullptr : p.mission.get();
  const bool has_given_up = has_no_way(s.phase);
  return {.robot = p.robot,
          .position = p.place,
          .velocity = p.failed ? Point2::Zero() : s.velocity,
          .goal = has_given_up ? std::nullopt : std::optional(mission ? mission->goal : p.place),
          .arrives_within = mission ? arrives_within(*mission) : 0,
          .wants_to_stay = !wants_to_go_on(s.phase),
          .radius = s.radius,
          .max_speed = s.max_speed,
          .rests_until = stands ? s.promise.expiry + p.clock.estimate() : s.stamp + p.clock.estimate(),
          .stands = stands,
          .failed = p.failed,
          .takes_no_part = s.phase == Phase::stopped || ((s.is_new || p.is_ignorant) && has_given_up),
          .round = s.round,
          .stage = s.stage,
          .progress = s.progress};
}

std::vector<Disc> Fleet::zones_of_failed(const Point2& position, double now) const {
  std::vector<Disc> places;
  for (const Peer& p : peers_) {
    const double covers = covers_rests(p);
    for (const Point2& rest : p.rests) {
      // Who stands closer than a plan would lead it must get away again.
      const double room = room_at(rest, position, now) - standing_gap;
      places.push_back({rest, std::clamp(room, 0.0, covers)});
    }
  }
  return places;
}

std::optional<FleetMember> Fleet::find(const RobotName& robot) const {
  const auto known = index_.find(robot);
  return known ? std::optional(member(peers_[*known])) : std::nullopt;
}

std::vector<FleetMember> Fleet::others() const {
  std::vector<FleetMember> all;
  for (const Peer& p : peers_) all.push_back(member(p));
  return all;
}

std::vector<FleetMember> Fleet::beside(const Point2& p, double radius, double sums) const {
  std::vector<FleetMember> close;
  for (const Peer& peer : peers_) {
    if ((peer.place - p).norm() <= sums * (radius + peer.radius)) close.push_back(member(peer));
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
    return far || peer.failed || !peer.state || peer.state->stage == Stage::free;
  });
}

double Fleet::cluster_reach(const Point2& p, double near) const {
  std::vector<Point2> outside;
  for (const Peer& peer : peers_) {
    if (!peer.failed) outside.push_back(peer.place);
  }
  double reach = near;
  std::vector<Point2> open{p};
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

double Fleet::clock_error(double now) const {
  return clock_error_ + clock_drift * (now - counted_at_);
}

bool Fleet::somebody_plans() const {
  return std::ranges::any_of(peers_,
                             [](const Peer& p) { return p.state && p.state->phase == Phase::planning; });
}

bool Fleet::run_is_over() const {
  return own_mission_ && own_mission_->cancelled &&
         std::ranges::all_of(peers_, [](const Peer& p) { return !p.mission || p.mission->cancelled; });
}

std::vector<RobotName> Fleet::robots_of_the_run() const {
  std::vector<RobotName> robots;
  if (own_mission_ && !own_mission_->cancelled) robots.push_back(self_);
  for (const Peer& p : peers_) {
    if (p.mission && !p.mission->cancelled) robots.push_back(p.robot);
  }
  return robots;
}

/// One that never came is at its start; but of before this one was started anew it knows nothing.
bool Fleet::is_known(const Peer& p) const {
  const bool done = p.mission && p.mission->cancelled && (p.state || !begun_anew_);
  return done || (p.state && p.clock.known()) || p.failed;
}

RobotName Fleet::unknown() const {
  const auto unknown = std::ranges::find_if_not(peers_, [&](const Peer& p) { return is_known(p); });
  return unknown == peers_.end() ? RobotName() : unknown->robot;
}

std::vector<RobotName> Fleet::missing() const {
  std::vector<RobotName> robots;
  for (const std::size_t number : missing_) robots.push_back(peers_[number].robot);
  return robots;
}

bool Fleet::complete(std::size_t robots) {
  all_known_ = all_known_ || std::ranges::all_of(peers_, [&](const Peer& p) { return is_known(p); });
  return all_known_ && peers_.size() + 1 >= robots;
}

}  // namespace coppice
