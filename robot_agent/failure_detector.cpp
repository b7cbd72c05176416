// Of Fleet: who has fallen silent, who counts as failed, and where.
#include <algorithm>
#include <cmath>
#include <limits>

#include "planning/quantities.h"
#include "robot_agent/fleet.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

// Seconds without a state (of the wall's clock, or of fleet time where that is slower: states come by fleet
// time) after which a robot counts as failed: far longer than a pause of a process or a run of lost samples
// lasts, for one that drives on unheard may touch those who think it failed.
constexpr double death = 2;
// Who is silent for longer is not cut off, but failed: networks heal within that time.
constexpr double longest_cut = 60;
constexpr double driven_cut_off = 3;  // seconds that one may drive on until it notices
// What was said last may have been lost, and what was heard last may have come late.
constexpr double unheard_before = 1;
constexpr double said_since = 0.5;
constexpr double longest_delay = 5;
// Who was out of touch may know more of the silent, and says so at every heartbeat.
constexpr double informs_for = 3;
constexpr double lost_before_it_is_away = 4;
// Without a state for so long a robot is missing: longer than samples are under way or a process pauses.
constexpr double absence = 1;
constexpr double long_absence = 1.5;
// The same for all others at once, where one is alone: nobody else needs to pause for that.
constexpr double loneliness = 0.6;
// Nobody says to have heard of this one, though it asks for that (Fleet::echoed), and is answered at once.
constexpr double longest_unheard = 1.8;
// The same for one that was never heard of: its process may still have to start.
constexpr double longest_startup = 10;
constexpr double from_the_beginning = 30;  // beyond that and the longest cut, no more
// Who is far away sends less often: so many states in a row may be lost before that is silence.
constexpr double lost_in_a_row = 10;
constexpr double heartbeat_seconds = heartbeat_interval * control_period;  // of one that stands close by
constexpr double looks_at_silence = 0.5;                                   // seconds between two
constexpr double relay_until = 4;    // seconds in which the last states of the silent are passed on
constexpr double rests_clear = 0.9;  // of its radius: it may have turned a little
constexpr double rests_radii = 0.1;  // between the places where a failed robot may stand
constexpr int halvings = 6;          // of that, where somebody else stands in between
constexpr double most_rests = 1e6;   // of one robot, whatever it says of its size and speed

/// Seconds; who sends at every so many turns may not be heard for so long.
double lost_over(int interval) {
  return lost_in_a_row * std::max(0.0, control_period * interval - heartbeat_seconds);
}

/// Until a robot stands that decides nothing more after this state.
double time_to_rest(const RobotState& s) {
  const int periods = braking_periods(s.promise.velocity.norm(), limits_of(s), control_period);
  return s.promise.expiry - s.stamp + periods * control_period;
}

/// On the way from a place where a robot may stand to one where it cannot.
template <class Possible>
Point2 last_possible(Point2 place, Point2 impossible, Possible&& possible) {
  for (int k = 0; k < halvings; ++k) {
    const Point2 middle = (place + impossible) / 2;
    (possible(middle) ? place : impossible) = middle;
  }
  return place;
}

}  // namespace

/// The last state of one that others no longer hear, passed on.
void Fleet::hear_again(Peer& p, WallTime arrived) {
  const bool paused = (arrived - p.said_again_at) * clock_.scale > relay_from * second();
  if (!p.said_again || paused) p.said_again_from = arrived;
  p.said_again = true;
  p.said_again_at = arrived;
  p.settled_until = all_settled_until_ = 0;
}

/// What one has heard of another robot of late tells that this is alive. A newer one is to be expected as
/// soon as the distances between the three allow.
void Fleet::hear_of_the_missing(const RobotState& state, const Peer& teller, double now) {
  for (const Echo& echo : state.echoes) {
    const auto known = index_.find(echo.robot);
    if (!known) continue;
    Peer& p = peers_[*known];
    const double newest = p.state ? std::max(p.echoed, p.state->stamp) : p.echoed;
    if (echo.stamp <= newest || is_from_the_future(echo.stamp, p, now)) continue;
    p.echoed = echo.stamp;
    const double between = (p.place - state.position).norm() - p.radius - state.radius;
    const int interval = std::max(
        {interval_from(p), interval_from(teller), send_interval(between, p.max_speed + state.max_speed)});
    p.echo_holds_until = std::max(p.echo_holds_until, now + death * second() + lost_over(interval));
  }
}

/// And that is newer than what is known of it.
bool Fleet::heard_elsewhere(const Peer& p, double now) const {
  return now < p.echo_holds_until && (!p.state || p.echoed > p.state->stamp);
}

std::optional<RobotName> Fleet::heard_by_others_only() const {
  const auto one = absences_.elsewhere;
  return one ? std::optional(peers_[*one].robot) : std::nullopt;
}

/// For so long nothing needs to come from it, because of how far away it is.
double Fleet::explained_silence(const Peer& p) const {
  return lost_over(p.state ? interval_from(p) : std::min(interval_from(p), handshake_interval()));
}

/// Robots without which all have waited for long enough may have come, driven and died.
bool Fleet::is_under_way(double now) const {
  return now > longest_startup * second();
}

/// More is missing than some lost samples, though it may not be enough to count as silent; or it comes when
/// the others are under way.
bool Fleet::was_away(const Peer& p, double now) const {
  if (!p.state) return is_under_way(now);
  const double unheard_for = since(p.heard_at, now) - long_absence * second();
  return unheard_for > 0 && unheard_for > lost_before_it_is_away * control_period * interval_from(p);
}

/// For so long nothing came that should have.
double Fleet::unheard(const Peer& p, double now) const {
  return std::max(0.0, since(p.heard_at, now) - explained_silence(p));
}

/// The same, or for so long those closer by have said that they hear no more of it.
double Fleet::silence(const Peer& p, double now) const {
  const double here = unheard(p, now);
  if (!p.said_again) return here;
  return std::max(here, relay_from * second() + (p.said_again_at - p.said_again_from) * clock_.scale);
}

bool Fleet::missing(const Peer& p, double seconds, double now) const {
  return p.state && !p.failed && silence(p, now) > seconds * second();
}

/// Nothing has changed while everybody was heard of a moment ago.
const Fleet::Absences& Fleet::absences(double now) {
  if (now >= all_settled_until_) count_absences(now);
  return absences_;
}

void Fleet::count_absences(double now) {
  absences_ = {};
  counted_at_ = now;
  missing_.clear();
  silent_failed_.clear();
  clock_error_ = 0;
  all_settled_until_ = now + looks_at_silence * second();
  for (Peer& p : peers_) {
    count_absence(p, now);
    if (p.clock.known() && !p.failed) clock_error_ = std::max(clock_error_, p.clock.error(now));
    absences_.alive += p.state && !p.failed;
    all_settled_until_ = std::min(all_settled_until_, p.settled_until);
  }
}

void Fleet::count_absence(Peer& p, double now) {
  Absences& count = absences_;
  const double silent = silence(p, now) / second();
  const auto number = static_cast<std::size_t>(&p - peers_.data());
  if (silent > long_absence && heard_elsewhere(p, now)) count.elsewhere = number;
  if (silent > absence) (p.failed ? silent_failed_ : missing_).push_back(number);
  count.failed += p.failed;
  if (p.failed) return;
  if (!p.state) {
    count.never_came += p.mission && silent > absence;
    return;
  }
  if (silent <= relay_from)
    p.settled_until = now + std::min(relay_from - silent, looks_at_silence) * second();
  count.unheard += silent > loneliness;
  count.absent += silent > absence;
  count.long_absent += silent > long_absence;
}

void Fleet::detect_failures(double now, const Point2& position, const RoundId& waits_in,
                            const ClearanceField& field) {
  position_ = position;
  waits_in_ = waits_in;
  leads_ = waits_in.leader == self_;
  leader_ = waits_in.epoch > 0 ? index_.find(waits_in.leader) : std::nullopt;
  const Absences count = absences(now);
  if (std::exchange(failure_reported_, false)) adopt_reported_failures(count, now, field);
  if (count.failed > 0 && now >= next_zone_check_) shrink_zones(now);
  if (some_suspected_) end_suspicions(now);
  if (count.never_came + count.absent > 0) declare_silent_failed(count, now, field);
  copies_ = count.alive > 0 ? loss_.copies_for(std::min(count.alive, sure_witnesses)) : 1;
  somebody_missing_ = count.absent + count.never_came + count.failed > 0;
  cut_off_ = now < minority_until_ || is_alone(count) || unheard_by_all(count, now) ||
             count.long_absent > 1 || count.elsewhere;
  out_of_touch_ = is_alone(count) || unheard_by_all(count, now) ||
                  (count.long_absent > 0 && 2 * count.long_absent >= count.alive);
}

/// Of two that miss each other the one with the first name goes on.
bool Fleet::is_alone(const Absences& count) const {
  if (count.alive == 0 || count.unheard < count.alive) return false;
  return count.alive > 1 ||
         std::ranges::any_of(peers_, [&](const Peer& p) { return p.state && !p.failed && p.robot < self_; });
}

bool Fleet::unheard_by_all(const Absences& count, double now) const {
  return count.alive > 0 && own_echo_ > 0 && now - own_echo_ > longest_unheard * second();
}

/// All others have said something since: so it is not part of a piece of the network, and if it is cut off,
/// then from all.
bool Fleet::silent_alone(const Peer& lost, double now) const {
  const double since_then = silence(lost, now) - said_since * second();
  return std::ranges::all_of(peers_, [&](const Peer& p) {
    return &p == &lost || !p.state || p.failed || age_of_last_sign(p, now) < since_then;
  });
}

/// Seconds, at most, since it said what it or somebody else was heard to say of it last.
double Fleet::age_of_last_sign(const Peer& p, double now) const {
  if (!p.clock.known()) return since(p.heard_at, now);
  return now - std::max(p.state->stamp, p.echoed) - p.clock.estimate() + p.clock.error(now);
}

/// One that decides nothing more is failed once it must stand, too. If several are missing, all are failed
/// when the first is.
void Fleet::declare_silent_failed(const Absences& count, double now, const ClearanceField& field) {
  const bool several = count.absent > 1;
  const bool over = std::ranges::any_of(peers_, [&](const Peer& p) {
    return missing(p, several ? longest_cut : death, now) && silence(p, now) > time_to_rest(*p.state) &&
           !heard_elsewhere(p, now) && (several || silent_alone(p, now));
  });
  std::vector<Peer*> lost;
  for (Peer& p : peers_) {
    const bool never_came =
        !p.state && p.mission && !begun_anew_ && silence(p, now) > longest_startup * second();
    const bool given_up = (never_came && !p.failed) || (over && missing(p, absence, now));
    if (given_up && !heard_elsewhere(p, now)) lost.push_back(&p);
  }
  if (lost.empty() || now - somebody_back_at_ < informs_for * second()) return;
  const std::size_t left = 1 + count.alive - count.absent;
  const std::vector<Peer*> missed = with_those_who_never_came(lost, now);
  const bool minority = is_minority(missed, left);
  if (minority) stand_as_minority(several, now);
  for (Peer* p : missed) p->across = minority;
  // Who fell silent with others may have driven on with them.
  const auto first_of_piece = std::stable_partition(lost.begin(), lost.end(), [&](const Peer* p) {
    return !several || !p->state || silent_alone(*p, now);
  });
  const auto until_noticed = static_cast<int>(std::ceil(driven_cut_off * second() / control_period));
  for (auto p = lost.begin(); p != lost.end(); ++p) {
    declare_failed(**p, p < first_of_piece ? unheard_states_of(**p, count) : until_noticed, field, now);
    if ((*p)->state) suspect(**p, now);
  }
}

/// A network may be in pieces from the beginning: then they are given up one by one, by when their missions
/// came. Later they are none of a piece: networks heal.
std::vector<Fleet::Peer*> Fleet::with_those_who_never_came(std::vector<Peer*> lost, double now) {
  if (now > (longest_startup + longest_cut + from_the_beginning) * second()) return lost;
  for (Peer& p : peers_) {
    if (p.failed && !p.state) lost.push_back(&p);
  }
  return lost;
}

/// Many may have died at once, but not within the time that a network takes to heal. One robot may have, or
/// many may never have been started.
void Fleet::stand_as_minority(bool several_fell_silent, double now) {
  const double until =
      several_fell_silent ? std::numeric_limits<double>::infinity() : now + longest_cut * second();
  minority_until_ = std::max(minority_until_, until);
}

int Fleet::unheard_states_of(const Peer& p, const Absences& count) const {
  const std::size_t left = 1 + count.alive - count.absent;
  return loss_.unheard_states(std::min(left, witnesses) * (p.state ? p.state->copies : 1));
}

/// They have waited for it as long as it takes.
void Fleet::adopt_reported_failures(const Absences& count, double now, const ClearanceField& field) {
  for (Peer& p : peers_) {
    if (std::exchange(p.reported_failed, false)) declare_failed(p, unheard_states_of(p, count), field, now);
  }
}

/// Of two pieces of equal size the one with the first name goes on.
bool Fleet::is_minority(std::span<Peer* const> lost, std::size_t left) const {
  if (lost.size() != left) return lost.size() > left;
  return std::ranges::any_of(lost, [&](const Peer* other) {
    return other->robot < self_ && std::ranges::none_of(peers_, [&](const Peer& p) {
             return !p.failed && std::ranges::find(lost, &p) == lost.end() && p.robot < other->robot;
           });
  });
}

/// Metres between the point and the nearest edge of a robot that is alive; this one is at `position`.
double Fleet::room_at(const Point2& q, const Point2& position, double now) const {
  double room = (q - position).norm() - own_mission_->radius;
  for (const Peer& p : peers_) {
    const bool known = p.state && !p.failed && !missing(p, absence, now);
    if (known) room = std::min(room, (q - p.place).norm() - p.radius);
  }
  return room;
}

/// Of the places where a failed robot may stand: so much around each, and nothing between two is left out.
double Fleet::covers_rests(const Peer& p) const {
  const double reach = own_mission_->radius + p.radius;
  return p.rests.size() < 2 ? p.radius : p.radius + std::hypot(reach, rests_radii * p.radius / 2) - reach;
}

/// Where one that is alive has come to stand meanwhile, no failed one does.
void Fleet::shrink_zones(double now) {
  next_zone_check_ = now + looks_at_silence;
  for (Peer& p : peers_) {
    if (p.rests.size() < 2 || !p.state) continue;
    const auto possible = [&](const Point2& rest) {
      return room_at(rest, position_, now) >= p.state->radius;
    };
    std::vector<Point2> left{p.rests.front()};
    bool was_possible = possible(p.rests.front());
    for (std::size_t k = 1; k < p.rests.size(); ++k) {
      const Point2& before = p.rests[k - 1];
      const Point2& rest = p.rests[k];
      const bool is_possible = possible(rest);
      if (was_possible && !is_possible) left.push_back(last_possible(before, rest, possible));
      // The first one stays, whoever stands there, and covers what is between.
      if (!was_possible && is_possible && k > 1) left.push_back(last_possible(rest, before, possible));
      if (is_possible) left.push_back(rest);
      was_possible = is_possible;
    }
    p.rests = std::move(left);
  }
}

/// It stands where it braked to after the last decision that anybody may know of, and not in an obstacle or
/// in one of us.
void Fleet::declare_failed(Peer& p, int unheard, const ClearanceField& field, double now) {
  p.settled_until = all_settled_until_ = 0;
  p.failed = true;
  if (!p.state) {
    p.rests = {p.place};
    return;
  }
  const RobotState& s = *p.state;
  const double furthest = s.max_speed * (unheard * control_period + longest_braking);
  const double step = std::max(rests_radii * s.radius, furthest / most_rests);
  p.rests = rests_after(commitment_of(s, 0), limits_of(s), control_period, unheard, step);
  const auto possible = [&](const Point2& q) {
    return field.is_free(q, rests_clear * s.radius) && room_at(q, position_, now) >= s.radius + standing_gap;
  };
  const auto end = std::find_if_not(p.rests.begin() + 1, p.rests.end(), possible);
  if (end != p.rests.end()) {
    *end = last_possible(*(end - 1), *end, possible);
    p.rests.erase(end + 1, p.rests.end());
  }
  p.place = p.rests.front();
}

/// If it is not failed, but cut off, it drives on until it notices that nobody hears it.
void Fleet::suspect(Peer& p, double now) {
  const Limits limits = limits_of(*p.state);
  const double seconds =
      (longest_unheard + unheard_before) * second() + std::min(p.clock.error(now), longest_delay);
  p.strays = limits.max_speed * seconds + braking_distance(limits.max_speed, limits, control_period);
  p.suspected_until = clock_.fleet_time(p.heard_at) + longest_cut * second();
  some_suspected_ = true;
}

bool Fleet::is_suspected_near(const Point2& p, double reach) const {
  return some_suspected_ && std::ranges::any_of(peers_, [&](const Peer& q) {
           return q.suspected_until > 0 && (q.place - p).norm() < q.strays + q.radius + reach;
         });
}

void Fleet::end_suspicions(double now) {
  some_suspected_ = false;
  for (Peer& p : peers_) {
    if (p.suspected_until == 0) continue;
    if (now < p.suspected_until) {
      some_suspected_ = true;
      continue;
    }
    p.suspected_until = 0;
    ++recoveries_;
  }
}

std::vector<RobotName> Fleet::peers_to_inform(double now) const {
  std::vector<RobotName> names;
  static_assert(absence <= informs_for);
  if (now - std::max(somebody_new_at_, somebody_back_at_) > informs_for * second()) return names;
  for (const Peer& p : peers_) {
    const bool is_new =
        p.state && p.state->is_new && !p.failed && since(p.heard_at, now) < absence * second();
    const bool is_back = p.back_at > 0 && now - p.back_at < informs_for * second();
    if (is_new || is_back) names.push_back(p.robot);
  }
  return names;
}

/// Who never came stands where its mission begins.
std::vector<RobotState> Fleet::states_of_silent_peers(double now) const {
  std::vector<RobotState> states;
  for (const Peer& p : peers_) {
    if (!p.failed && !(p.state && unheard(p, now) > relay_from * second())) continue;
    if (p.state) {
      states.push_back(*p.state);
    } else {
      const Mission& m = *p.mission;
      states.push_back({.robot = p.robot,
                        .position = p.place,
                        .radius = m.radius,
                        .max_speed = m.max_speed,
                        .max_acceleration = m.max_acceleration,
                        .run = clock_.epoch});
    }
    states.back().passed_on = true;
    states.back().counts_as_failed = p.failed && p.suspected_until == 0;
  }
  return states;
}

std::vector<RobotState> Fleet::last_words(double now) const {
  std::vector<RobotState> states;
  if (now < all_settled_until_) return states;
  for (const Peer& p : peers_) {
    const double silent = unheard(p, now) / second();
    if (!p.state || silent <= relay_from || silent >= relay_until) continue;
    states.push_back(*p.state);
    states.back().passed_on = true;
  }
  return states;
}

}  // namespace coppice
