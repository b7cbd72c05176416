#include "robot_agent/peers/failure_detector.h"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "coppice/motion/kinematics.h"
#include "motion/trajectory/segments.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

constexpr double heartbeat_seconds = heartbeat_interval * control_period;  // of a peer that stands close by

/// Seconds for which nothing may be heard of a peer that sends at every so many ticks.
double lost_over(int interval) {
  return Timing::lost_in_a_row * std::max(0.0, control_period * interval - heartbeat_seconds);
}

/// Seconds from this state until the robot stands, if it decides nothing more.
double time_to_rest(const RobotState& s) {
  const int periods = braking_periods(s.promise.next_velocity.norm(), limits_of(s), control_period);
  return s.promise.expiry - s.promise.stamp + periods * control_period;
}

}  // namespace

void FailureDetector::forget_peers() {
  count_.missing.clear();
  count_.silent_failed.clear();
  count_.elsewhere.reset();
  back_at_ = new_at_ = long_ago;
  own_echo_ = any_echo_ = away_at_ = 0;
  may_be_unknown_ = true;
}

void FailureDetector::keep(const Peer& p) {
  if (p.state->is_new) new_at_ = std::max(new_at_, own_.clock().fleet_time(p.heard_at));
}

void FailureDetector::hear_own_echoes(const RobotState& state, Peer& teller, double now) {
  for (const Echo& echo : state.echoes) {
    if (echo.robot != own_.name || echo.stamp > now) continue;  // nobody has heard what is still to be said
    teller.clock.hear_echo(echo.stamp, echo.received, now);
    teller.has_heard = std::max(teller.has_heard, echo.stamp);
    any_echo_ = std::max(any_echo_, echo.stamp);
    if (!state.may_be_unknown) own_echo_ = std::max(own_echo_, echo.stamp);
  }
}

/// Others may take this robot for failed, and may not notice at once that it is back.
void FailureDetector::go_away(double now) {
  away_at_ = now;
  may_be_unknown_ = true;
}

/// All know a robot again when each peer that is alive has said that it heard the robot since. All of these
/// peers heard the oldest of the states that they name. So that state proves contact.
void FailureDetector::note_whether_all_know(double now) {
  if (is_away(now)) return go_away(now);
  if (!may_be_unknown_) return;
  double all_have_heard = now;
  for (const Peer& p : peers_) {
    const bool may_come = p.expected() && p.mission && !p.mission->cancelled;
    if (p.alive() || may_come) all_have_heard = std::min(all_have_heard, p.has_heard);
  }
  if (all_have_heard <= away_at_) return;
  may_be_unknown_ = false;
  own_echo_ = std::max(own_echo_, count_.alive > 0 ? all_have_heard : 0.0);
}

/// An echo of a state of another peer shows that peer alive. A newer echo is to be expected as soon as the
/// distances between the three robots allow.
void FailureDetector::hear_of_missing(const RobotState& state, const Peer& teller, double now) {
  for (const Echo& echo : state.echoes) {
    const auto known = peers_.find(echo.robot);
    if (!known) continue;
    Peer& p = peers_[*known];
    HeardElsewhere& elsewhere = p.elsewhere;
    const double newest = p.state ? std::max(elsewhere.stamp, p.state->promise.stamp) : elsewhere.stamp;
    if (echo.stamp <= newest || own_.is_from_the_future(echo.stamp, p, now)) continue;
    elsewhere.stamp = echo.stamp;
    const double between = (p.place - state.promise.position).norm() - p.radius - state.radius;
    const int interval = std::max({own_.interval_from(p), own_.interval_from(teller),
                                   send_interval(between, p.max_speed + state.max_speed)});
    elsewhere.holds_until =
        std::max(elsewhere.holds_until, now + Timing::failure_timeout * own_.second() + lost_over(interval));
  }
}

void FailureDetector::hear_relay(Peer& p, WallTime arrived) {
  const bool goes_on =
      p.relayed && (arrived - p.relayed->last) * own_.clock().scale <= Timing::relay_from * own_.second();
  if (!goes_on) p.relayed = std::make_unique<Relayed>(Relayed{arrived, arrived});
  p.relayed->last = arrived;
  p.settled_until = settled_until_ = 0;
}

/// A newer state than the last one that came here.
bool FailureDetector::heard_elsewhere(const Peer& p, double now) const {
  return now < p.elsewhere.holds_until && (!p.state || p.elsewhere.stamp > p.state->promise.stamp);
}

/// For so long nothing needs to come from a peer, because of how far away it is.
double FailureDetector::explained_silence(const Peer& p) const {
  const int interval = own_.interval_from(p);
  return lost_over(p.state ? interval : std::min(interval, handshake_interval(peers_.size())));
}

double FailureDetector::unheard(const Peer& p, double now) const {
  return std::max(0.0, own_.since(p.heard_at, now) - explained_silence(p));
}

/// The same; or for so long peers that are closer by have said that they hear no more of it.
double FailureDetector::silence(const Peer& p, double now) const {
  const double here = unheard(p, now);
  if (!p.relayed) return here;
  const double relayed = (p.relayed->last - p.relayed->first) * own_.clock().scale;
  return std::max(here, Timing::relay_from * own_.second() + relayed);
}

bool FailureDetector::is_missing(const Peer& p, double seconds, double now) const {
  return p.alive() && silence(p, now) > seconds * own_.second();
}

void FailureDetector::count(double now) {
  Absences count{.at = now};
  count.missing = std::move(count_.missing);
  count.silent_failed = std::move(count_.silent_failed);
  count.missing.clear();
  count.silent_failed.clear();
  count_ = std::move(count);
  settled_until_ = now + Timing::count_interval * own_.second();
  for (Peer& p : peers_) {
    this->count(p, now);
    settled_until_ = std::min(settled_until_, p.settled_until);
  }
}

void FailureDetector::count(Peer& p, double now) {
  const double silent = silence(p, now) / own_.second();
  const std::size_t number = peers_.number_of(p);
  if (silent > Timing::long_absence && heard_elsewhere(p, now)) count_.elsewhere = number;
  if (silent > Timing::absence) (p.failed() ? count_.silent_failed : count_.missing).push_back(number);
  if (p.failed()) {
    ++count_.failed;
    return;
  }
  if (p.clock.known()) count_.clock_error = std::max(count_.clock_error, p.clock.error(now));
  if (!p.alive()) {
    count_.never_came += p.mission && silent > Timing::absence;
    return;
  }
  if (silent <= Timing::relay_from) {
    const double settled = std::min(Timing::relay_from - silent, Timing::count_interval);
    p.settled_until = now + settled * own_.second();
  }
  ++count_.alive;
  count_.unheard += silent > Timing::loneliness;
  count_.absent += silent > Timing::absence;
  count_.long_absent += silent > Timing::long_absence;
}

void FailureDetector::judge(double now, const ClearanceField& field, const LossCount& loss) {
  if (!all_settled(now)) count(now);
  if (std::exchange(some_reported_, false)) adopt_reported_failures(field, loss);
  if (count_.failed > 0 && now >= next_pruning_) prune_zones(now);
  if (some_suspected_) end_suspicions(now);
  if (count_.never_came + count_.absent > 0) declare_silent_failed(now, field, loss);
  note_whether_all_know(now);
  contact_ = contact(now);
}

FailureDetector::Contact FailureDetector::contact(double now) const {
  const bool lost_all = is_alone() || is_unheard(own_echo_, now);
  const std::size_t lost = count_.long_absent;
  return {.cut_off = is_away(now) || lost_all || count_.elsewhere,
          .out_of_touch = lost_all || (lost > 0 && 2 * lost >= count_.alive)};
}

/// All others may take this robot for failed.
bool FailureDetector::is_away(double now) const {
  return now < minority_until_ || count_.long_absent > 1 || is_alone() || is_unheard(any_echo_, now);
}

/// Of two robots that miss each other, the one with the first name goes on.
bool FailureDetector::is_alone() const {
  if (count_.alive == 0 || count_.unheard < count_.alive) return false;
  return count_.alive > 1 ||
         std::ranges::any_of(peers_, [&](const Peer& p) { return p.alive() && p.robot < own_.name; });
}

/// Whether the newest of the echoes that count is too old.
bool FailureDetector::is_unheard(double newest_echo, double now) const {
  return count_.alive > 0 && newest_echo > 0 && now - newest_echo > Timing::longest_unheard * own_.second();
}

/// All others have said something since. So the peer is not part of a piece of the network. If it is cut off,
/// it is cut off from all.
bool FailureDetector::silent_alone(const Peer& lost, double now) const {
  const double since_then = silence(lost, now) - Timing::said_since * own_.second();
  return std::ranges::all_of(peers_, [&](const Peer& p) {
    return &p == &lost || !p.alive() || age_of_last_sign(p, now) < since_then;
  });
}

/// Seconds, at most, since the peer said what was last heard of it, here or elsewhere.
double FailureDetector::age_of_last_sign(const Peer& p, double now) const {
  if (!p.clock.known()) return own_.since(p.heard_at, now);
  return now - std::max(p.state->promise.stamp, p.elsewhere.stamp) - p.clock.estimate() + p.clock.error(now);
}

/// The first who told of these peers waited for them as long as it takes.
void FailureDetector::adopt_reported_failures(const ClearanceField& field, const LossCount& loss) {
  for (Peer& p : peers_) {
    const auto* const alive = std::get_if<liveness::Alive>(&p.liveness);
    if (alive != nullptr && alive->reported_failed) declare_failed(p, unheard_states_of(p, loss), field);
  }
}

/// The peers that are to be declared failed. A silent robot must stand by now, too. If several are missing,
/// all are lost when the first is.
std::vector<Peer*> FailureDetector::lost_peers(double now) {
  const bool several = count_.absent > 1;
  const double timeout = several ? Timing::longest_partition : Timing::failure_timeout;
  const bool over = std::ranges::any_of(peers_, [&](const Peer& p) {
    return is_missing(p, timeout, now) && silence(p, now) > time_to_rest(*p.state) &&
           !heard_elsewhere(p, now) && (several || silent_alone(p, now));
  });
  std::vector<Peer*> lost;
  for (Peer& p : peers_) {
    const bool may_come = p.expected() && p.mission && !own_.began_in_mid_run;
    const bool never_came = may_come && silence(p, now) > Timing::longest_startup * own_.second();
    const bool given_up = never_came || (over && is_missing(p, Timing::absence, now));
    if (given_up && !heard_elsewhere(p, now)) lost.push_back(&p);
  }
  return lost;
}

void FailureDetector::declare_silent_failed(double now, const ClearanceField& field, const LossCount& loss) {
  const bool several = count_.absent > 1;
  std::vector<Peer*> lost = lost_peers(now);
  if (lost.empty() || now - back_at_ < Timing::informs_for * own_.second()) return;
  const std::vector<Peer*> missed = with_those_who_never_came(lost, now);
  const bool minority = is_minority(missed);
  if (minority) stand_as_minority(now);
  // A peer that fell silent with others may have driven on with them.
  const auto first_of_piece = std::stable_partition(lost.begin(), lost.end(), [&](const Peer* p) {
    return !several || !p->state || silent_alone(*p, now);
  });
  const auto until_noticed =
      static_cast<int>(std::ceil(Timing::driven_cut_off * own_.second() / control_period));
  for (auto p = lost.begin(); p != lost.end(); ++p) {
    declare_failed(**p, p < first_of_piece ? unheard_states_of(**p, loss) : until_noticed, field);
    if ((*p)->state) suspect(**p, now);
  }
  for (Peer* p : missed) p->failure()->in_larger_piece = minority;
}

/// A network may be in pieces from the beginning. Then peers are given up one by one, by when their missions
/// came; and a single peer that was heard before the network fell apart is suspected before that. Later these
/// are not part of a piece: networks heal.
std::vector<Peer*> FailureDetector::with_those_who_never_came(std::vector<Peer*> lost, double now) {
  constexpr double pieces_end =
      Timing::longest_startup + Timing::longest_partition + Timing::pieces_from_the_beginning;
  if (now > pieces_end * own_.second()) return lost;
  for (Peer& p : peers_) {
    const bool may_be_elsewhere = p.failed() && (!p.state || p.suspicion() != nullptr);
    if (may_be_elsewhere && std::ranges::find(lost, &p) == lost.end()) lost.push_back(&p);
  }
  return lost;
}

/// Many peers may have failed at once, but not within the time in which a network heals. A single peer may
/// have failed, or many may never have been started.
void FailureDetector::stand_as_minority(double now) {
  const bool several_fell_silent = count_.absent > 1;
  const double until = several_fell_silent ? std::numeric_limits<double>::infinity()
                                           : now + Timing::longest_partition * own_.second();
  minority_until_ = std::max(minority_until_, until);
}

/// Of two pieces of equal size, the one with the first name goes on.
bool FailureDetector::is_minority(std::span<Peer* const> lost) const {
  if (lost.size() != count_.left()) return lost.size() > count_.left();
  return std::ranges::any_of(lost, [&](const Peer* other) {
    return other->robot < own_.name && std::ranges::none_of(peers_, [&](const Peer& p) {
             return !p.failed() && std::ranges::find(lost, &p) == lost.end() && p.robot < other->robot;
           });
  });
}

/// A peer chooses its copies so that no state is unheard by its own count. An agent that has counted little
/// takes the peer's word, unless the peer sent as if nobody listened.
int FailureDetector::unheard_states_of(const Peer& p, const LossCount& loss) const {
  const std::size_t copies = p.state ? p.state->copies : 1;
  const std::size_t samples = std::min(count_.left(), witnesses) * copies;
  const bool peer_has_counted = samples >= LossCount::fewest_samples && copies < Timing::most_copies;
  return loss.knows_little() && peer_has_counted ? 0 : loss.unheard_states(samples);
}

/// The peer stands where it braked to after the last decision that anybody may know of, and not in an
/// obstacle.
void FailureDetector::declare_failed(Peer& p, int unheard, const ClearanceField& field) {
  p.settled_until = settled_until_ = 0;
  p.liveness = liveness::Failed{};
  Zone& zone = p.failure()->zone;
  if (!p.state) {
    zone.rests = {p.place};
    return;
  }
  zone = zone_after(*p.state, own_.clock().fleet_time(p.heard_at), unheard, field);
  p.place = zone.rests.front();
}

/// A peer that was just declared failed may only be cut off. Then it drives on until it notices that nobody
/// hears it, and brakes, which may take it longer than a network is in pieces.
void FailureDetector::suspect(Peer& p, double now) {
  const Limits limits = limits_of(*p.state);
  const double seconds = (Timing::longest_unheard + Timing::unheard_before) * own_.second() +
                         std::min(p.clock.error(now), Timing::largest_clock_error);
  const double moves_for = (1 + clock_drift) * (seconds + 2 * control_period + braking_time(limits));
  liveness::Suspected suspected;
  *suspected.suspicion = {
      .failure = std::move(*p.failure()),
      .until = own_.clock().fleet_time(p.heard_at) +
               std::max(Timing::longest_partition * own_.second(), moves_for),
      .strays = limits.max_speed * seconds + braking_distance(limits.max_speed, limits, control_period)};
  p.liveness = std::move(suspected);
  some_suspected_ = true;
}

void FailureDetector::end_suspicions(double now) {
  some_suspected_ = false;
  for (Peer& p : peers_) {
    if (p.suspicion() == nullptr) continue;
    if (now < p.suspicion()->until) {
      some_suspected_ = true;
      continue;
    }
    liveness::Failed failed;
    *failed.failure = std::move(*p.failure());
    p.liveness = std::move(failed);
    ++recoveries_;
  }
}

bool FailureDetector::is_suspected_near(const Point2& p, double reach) const {
  return some_suspected_ && std::ranges::any_of(peers_, [&](const Peer& q) {
           const Suspicion* const suspicion = q.suspicion();
           return suspicion != nullptr && (q.place - p).norm() < suspicion->strays + q.radius + reach;
         });
}

/// Where a robot that is alive has been since a failed one came to rest, that one does not stand.
void FailureDetector::prune_zones(double now) {
  next_pruning_ = now + Timing::count_interval;
  for (Peer& p : peers_) {
    if (!p.failed() || !p.state) continue;
    Zone& zone = p.failure()->zone;
    prune(zone, p.state->radius,
          [&](const Point2& q) { return room_at(q, own_.position, zone.at_rest_from, now); });
  }
}

void FailureDetector::learn_from(const JointPlanMessage& plan, double offset) {
  if (count_.failed == 0) return;
  double departs = std::numeric_limits<double>::infinity();
  for (const JointPlanMessage::Member& member : plan.members) {
    if (!member.trajectory.empty()) departs = std::min(departs, member.trajectory.front().time + offset);
  }
  // A leader that does not yet hold the robot for failed may plan ways through where it stands.
  const double all_know_after = Timing::all_know_of_failures_after * own_.second();
  const auto room_beside_moves = [&](const Point2& q) {
    double room = std::numeric_limits<double>::infinity();
    for (const JointPlanMessage::Member& member : plan.members) {
      if (!member.trajectory.empty())
        room = std::min(room, point_path_distance(q, path_of(member.trajectory)) - member.radius);
    }
    return room;
  };
  for (Peer& p : peers_) {
    const bool is_member =
        std::ranges::find(plan.members, p.robot, &JointPlanMessage::Member::robot) != plan.members.end();
    if (!p.failed() || !p.state || is_member) continue;
    Zone& zone = p.failure()->zone;
    if (departs > zone.at_rest_from + all_know_after) prune(zone, p.state->radius, room_beside_moves);
  }
}

double FailureDetector::room_at(const Point2& q, const Point2& position, double since, double now) const {
  double room = std::numeric_limits<double>::infinity();
  if (now >= since) room = (q - position).norm() - own_.mission->radius;
  for (const Peer& p : peers_) {
    const bool is_heard = p.alive() && !is_missing(p, Timing::absence, now);
    if (!is_heard) continue;
    const double stamp = p.state->promise.stamp + p.clock.estimate() - p.clock.error(now);
    if (stamp >= since) room = std::min(room, (q - p.place).norm() - p.radius);
  }
  return room;
}

}  // namespace coppice
