#include "robot_agent/peers/dissemination.h"

#include <algorithm>
#include <utility>

#include "messages/validation.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr std::size_t most_answers = most_echoes / 2;  // echoes in a state, for peers that miss somebody

}  // namespace

void Dissemination::forget_peers() {
  next_echo_ = chosen_among_ = 0;
  missed_by_others_.clear();
}

bool Dissemination::is_synchronised(const Peer& p) const {
  return p.clock.known() && p.exchange.handshakes >= Timing::handshakes_needed;
}

/// A leader waits for all members that wait, and these wait for the leader.
bool Dissemination::tells_about_round(const Peer& p) const {
  if (const auto* follows = std::get_if<OwnRobot::Follows>(&own_.wait))
    return follows->leader == peers_.number_of(p);
  const auto* const leads = std::get_if<OwnRobot::Leads>(&own_.wait);
  return leads != nullptr && p.state && (leads->round.includes(p.place) || p.state->round == leads->round);
}

/// The peer may have come closer since it was heard.
int Dissemination::interval_to(const Peer& p, double now) const {
  const double gap = own_.gap(p) - p.max_speed * own_.since(p.heard_at, now);
  const int interval = send_interval(gap, own_.closing_speed(p));
  if (!p.state) return std::min(interval, handshake_interval(peers_.size()));
  return p.exchange.waits_for_this ? 1 : interval;
}

/// In this tick. The send interval is looked at again from time to time only.
bool Dissemination::is_told(std::size_t number, std::uint32_t tick, double now) {
  Peer& p = peers_[number];
  StateExchange& e = p.exchange;
  const bool is_in_turn = e.is_in_turn;
  e.is_in_turn = false;
  if (is_in_turn || e.is_witness || (own_.waits() && tells_about_round(p))) return true;
  if (tick >= e.interval_until) {
    e.interval = static_cast<std::uint8_t>(interval_to(p, now));
    e.interval_until = tick + static_cast<std::uint32_t>(e.interval / Timing::checks_per_interval);
  }
  peers_.told_from[number] = std::min(e.interval_until, next_tick_of(e.phase, tick, e.interval));
  return is_tick_of(e.phase, tick, e.interval);
}

/// The nearest peers that are not failed.
void Dissemination::choose_witnesses() {
  std::vector<std::pair<double, Peer*>> candidates;
  candidates.reserve(peers_.size());
  for (Peer& p : peers_) {
    if (!p.failed())
      candidates.emplace_back(own_.gap(p) * (p.exchange.is_witness ? Timing::kept_witness : 1), &p);
    p.exchange.is_witness = false;
  }
  const std::size_t few = std::min(witnesses, candidates.size());
  std::ranges::nth_element(candidates, candidates.begin() + static_cast<std::ptrdiff_t>(few));
  for (std::size_t k = 0; k < few; ++k) {
    Peer& p = *candidates[k].second;
    p.exchange.is_witness = true;
    peers_.told_from[peers_.number_of(p)] = 0;
  }
  chosen_among_ = peers_.size();
}

/// The next few of the peers that were heard and may not know this robot's clock, and of those that ask for
/// an echo. They come after the one that got the last echo.
void Dissemination::choose_in_turn(std::size_t most) {
  if (!shakes_hands_ && !somebody_asks_) return;
  shakes_hands_ = somebody_asks_ = false;
  std::size_t chosen = 0;
  for (std::size_t k = 0; k < peers_.size(); ++k) {
    const std::size_t number = (last_echo_ + 1 + k) % peers_.size();
    Peer& p = peers_[number];
    const bool shakes_hands = p.alive() && !is_synchronised(p);
    if (!shakes_hands && !p.exchange.asks) continue;
    shakes_hands_ = shakes_hands_ || shakes_hands;
    somebody_asks_ = somebody_asks_ || p.exchange.asks;
    if (chosen == most) continue;
    ++chosen;
    p.exchange.is_in_turn = true;
    peers_.told_from[number] = 0;
  }
}

Dissemination::Address Dissemination::address(std::uint32_t tick, const RoundId* news,
                                              const RobotName& waits_for, bool busy, double now) {
  if (!own_.mission) return {};
  if (is_tick_of(0, tick, Timing::ticks_per_choice) || peers_.size() != chosen_among_) choose_witnesses();
  choose_in_turn(busy ? Timing::answers_if_busy : Timing::answers_a_tick);
  const auto awaited = peers_.find(waits_for);
  std::vector<Peer*> addressed;
  addressed.reserve(peers_.size());
  const bool tells_of_a_round = news != nullptr || own_.waits();
  for (std::size_t k = 0; k < peers_.size(); ++k) {
    const bool is_awaited = k == awaited;
    if (tick < peers_.told_from[k] && !tells_of_a_round && !is_awaited) continue;  // nearly always
    Peer& p = peers_[k];
    const bool in_round = news != nullptr && p.state && (news->includes(p.place) || p.state->round == *news);
    if (in_round || is_awaited || is_told(k, tick, now)) addressed.push_back(&p);
  }
  Address to{.agents = {}, .echoes = next_echoes(addressed, tick), .misses = next_missing()};
  to.agents.reserve(addressed.size());
  for (const Peer* p : addressed) to.agents.push_back(p->robot);
  return to;
}

/// A fleet that begins has many peers without a handshake. They hear of this robot until that is over.
std::vector<RobotName> Dissemination::who_hears_copies(std::span<const RobotName> agents) const {
  std::vector<RobotName> recipients;
  recipients.reserve(agents.size());
  for (const RobotName& robot : agents) {
    const auto known = peers_.find(robot);
    if (known && (peers_[*known].exchange.is_witness || is_synchronised(peers_[*known])))
      recipients.push_back(robot);
  }
  return recipients;
}

/// The peer says something itself, and of late, for its distance.
bool Dissemination::hears(const Peer& p, double now) const {
  return p.alive() && !p.state->passed_on && detector_.unheard(p, now) < Timing::relay_from * own_.second();
}

/// The peer misses somebody that is heard here: the next state says so. No two states say so shortly after
/// each other, for peers that answer may miss somebody, too.
bool Dissemination::answers(std::size_t asker, double now) {
  Peer& p = peers_[asker];
  const RobotState& state = *p.state;
  if (!own_.mission || state.passed_on) return false;
  p.exchange.misses_somebody = std::ranges::find(state.misses, own_.name) != state.misses.end();
  if (state.misses.empty()) return false;  // nearly always
  bool tells = false;
  const bool is_due = now >= peers_.answered_until[asker];
  for (const RobotName& missed : state.misses) {
    const auto known = peers_.find(missed);
    if (!known || !hears(peers_[*known], now)) continue;
    p.exchange.misses_somebody = tells = true;
    const bool noted = std::ranges::find(missed_by_others_, *known) != missed_by_others_.end();
    if (is_due && !noted && missed_by_others_.size() < most_answers) missed_by_others_.push_back(*known);
  }
  if (!is_due || !tells) return false;
  peers_.answered_until[asker] = now + Timing::between_answers * own_.second();
  return true;
}

/// Names all missing peers in each state if they are few. Otherwise each state goes on where the last one
/// ended. The positions to go on from are odd in number: so peers that receive every second, fourth, ...
/// state hear of all.
std::vector<RobotName> Dissemination::next_missing() {
  std::vector<RobotName> names;
  for (const auto* some : {&detector_.missing(), &detector_.silent_failed()}) {
    const std::size_t size = some->size();
    for (std::size_t k = 0; k < size && names.size() < most_missed; ++k) {
      const std::size_t next = size <= most_missed ? k : (asked_for_ + k) % (size | 1);
      if (next < size) names.push_back(peers_[(*some)[next]].robot);
    }
  }
  asked_for_ += most_missed;
  return names;
}

/// Echoes of peers that others miss; then of recipients that ask for one, that are in a handshake, or that
/// hear few states; from time to time of whatever else is news.
std::vector<Echo> Dissemination::next_echoes(std::span<Peer* const> addressed, std::uint32_t tick) {
  std::vector<Echo> echoes;
  const auto echo_of = [&](const Peer& p) {
    return Echo{p.robot, p.state->promise.stamp, own_.clock().fleet_time(p.heard_at)};
  };
  const auto add = [&](Peer& p) {
    if (echoes.empty())
      echoes.reserve(Timing::echoes_a_state);  // most states have none, and are kept for long
    p.echo_sent = p.state->promise.stamp;
    p.exchange.asks = false;
    echoes.push_back(echo_of(p));
  };
  for (const std::size_t missed : std::exchange(missed_by_others_, {}))
    echoes.push_back(echo_of(peers_[missed]));
  const std::size_t most_news = echoes.size() + Timing::echoes_a_state;
  const auto first =
      std::ranges::upper_bound(addressed, last_echo_, {}, [&](Peer* p) { return peers_.number_of(*p); });
  const auto begin = static_cast<std::size_t>(first - addressed.begin());
  for (std::size_t k = 0; k < addressed.size() && echoes.size() < most_echoes; ++k) {
    Peer& p = *addressed[(begin + k) % addressed.size()];
    if (!p.state) continue;
    const bool in_time =
        p.exchange.interval < Timing::rare || p.state->promise.stamp - p.echo_sent < Timing::between_echoes;
    if (in_time && is_synchronised(p) && !p.exchange.asks) continue;
    add(p);
    last_echo_ = peers_.number_of(p);
    if (p.clock.known() && !is_synchronised(p)) ++p.exchange.handshakes;
  }
  const bool all_news = is_tick_of(0, tick, Timing::ticks_per_echo);
  for (std::size_t k = 0; all_news && k < peers_.size() && echoes.size() < most_news; ++k) {
    next_echo_ = next_echo_ + 1 < peers_.size() ? next_echo_ + 1 : 0;
    Peer& p = peers_[next_echo_];
    if (p.state && p.echo_sent != p.state->promise.stamp) add(p);
  }
  return echoes;
}

Dissemination::Relay Dissemination::last_words(double now) {
  if (detector_.all_settled(now)) return {};
  std::vector<const Peer*> silent;
  std::vector<const Peer*> hearers;
  for (const Peer& p : peers_) {
    const double unheard = detector_.unheard(p, now) / own_.second();
    if (p.state && unheard > Timing::relay_from && unheard < Timing::relay_until) silent.push_back(&p);
    hearers.push_back(&p);
  }
  if (silent.empty()) return {};
  relayed_.leave_next(silent, Timing::relayed_at_once);
  relayed_to_.leave_next(hearers, Timing::relayed_at_once);
  Relay relay;
  for (const Peer* p : silent) relay.states.push_back(last_state(*p));
  for (const Peer* p : hearers) relay.hearers.push_back(p->robot);
  return relay;
}

Dissemination::Relay Dissemination::news_for_those_back(double now) {
  Relay relay{.states = {}, .hearers = those_back(now)};
  if (relay.hearers.empty()) return relay;
  std::vector<const Peer*> gone;
  for (const Peer& p : peers_) {
    const bool is_silent = p.state && detector_.unheard(p, now) > Timing::relay_from * own_.second();
    if (p.failed() || is_silent) gone.push_back(&p);
  }
  relayed_.leave_next(gone, Timing::relayed_at_once);
  relayed_to_.leave_next(relay.hearers, Timing::relayed_at_once);
  for (const Peer* p : gone) {
    relay.states.push_back(last_state(*p));
    relay.states.back().counts_as_failed = std::holds_alternative<liveness::Failed>(p->liveness);
  }
  return relay;
}

std::vector<RobotName> Dissemination::those_back(double now) const {
  std::vector<RobotName> names;
  const double informs_for = Timing::informs_for * own_.second();
  if (now - std::max(detector_.new_at(), detector_.back_at()) > informs_for) return names;
  for (const Peer& p : peers_) {
    const bool is_new =
        p.alive() && p.state->is_new && own_.since(p.heard_at, now) < Timing::absence * own_.second();
    const bool is_back = p.back_at && now - *p.back_at < informs_for;
    if (is_new || is_back) names.push_back(p.robot);
  }
  return names;
}

/// To be relayed. A peer that never came stands where its mission begins.
RobotState Dissemination::last_state(const Peer& p) const {
  RobotState last = p.state ? *p.state
                            : RobotState{.robot = p.robot,
                                         .promise = {.position = p.place},
                                         .radius = p.radius,
                                         .max_speed = p.max_speed,
                                         .max_acceleration = p.mission->max_acceleration,
                                         .run = own_.clock().run(),
                                         .max_angular_speed = p.mission->max_angular_speed,
                                         .max_angular_acceleration = p.mission->max_angular_acceleration};
  last.passed_on = true;
  return last;
}

}  // namespace coppice
