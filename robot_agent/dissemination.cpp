// Of Fleet: whom a state is for (interest.h).
#include <algorithm>
#include <bit>
#include <utility>

#include "messages/validation.h"
#include "robot_agent/fleet.h"

namespace coppice {

namespace {

constexpr int checks_per_interval = 2;  // whether it is still right
constexpr int ticks_per_choice = 8;     // of the witnesses
constexpr std::size_t echoes_a_state = 8;
constexpr std::size_t most_answers = most_echoes / 2;  // likewise, to those who miss somebody
constexpr double between_answers = 0.5;                // seconds, to each of these
constexpr int ticks_per_echo = 4;
constexpr int rare = 8;               // a interval, of those who get echoes of their own
constexpr double between_echoes = 1;  // seconds, of each of these: clocks do not drift far in them
// Until clocks are compared; for that, the other must hear of it.
constexpr int handshakes_needed = 5;
constexpr std::size_t handshakes_per_tick = 8;  // each robot tells so many of itself, about
constexpr int longest_handshake_interval = 32;

}  // namespace

bool Fleet::is_synchronised(const Peer& p) const {
  return p.clock.known() && p.handshakes >= handshakes_needed;
}

/// All strangers of all robots are many.
int Fleet::handshake_interval() const {
  const auto ticks = std::bit_floor(std::max<std::size_t>(1, peers_.size() / handshakes_per_tick));
  return std::min(longest_handshake_interval, static_cast<int>(ticks));
}

/// A leader waits for all who hold, and these for it.
bool Fleet::tells_about_round(const Peer& p) const {
  if (!leads_) return leader_ && &p == &peers_[*leader_];
  return p.state && (waits_in_.includes(p.place) || p.state->round == waits_in_);
}

bool Fleet::hears_about_round_from(const Peer& p) const {
  return p.state && p.state->stage == Stage::waiting && (leads_ || waits_in_.leader == p.robot) &&
         p.state->round == waits_in_;
}

/// It may have come closer since it was heard of.
int Fleet::interval_to(const Peer& p, double now) const {
  const int interval = send_interval(gap(p) - p.max_speed * since(p.heard_at, now), closing_speed(p));
  if (!is_synchronised(p)) return std::min(interval, handshake_interval());
  return p.waits_for_this ? 1 : interval;
}

/// In this tick. At every one, or else at those of its interval, which is looked at anew from time to time
/// only.
bool Fleet::is_told(std::size_t number, std::uint32_t tick, double now) {
  Peer& p = peers_[number];
  if (p.is_witness || (waits_in_.epoch > 0 && tells_about_round(p)) || p.asks) return true;
  if (tick >= p.interval_until) {
    p.interval = interval_to(p, now);
    p.interval_until = tick + static_cast<std::uint32_t>(p.interval / checks_per_interval);
  }
  told_from_[number] = std::min(p.interval_until, next_tick_of(p.phase, tick, p.interval));
  return is_tick_of(p.phase, tick, p.interval);
}

/// By a wide margin: it may think that this robot is further away.
bool Fleet::tells_at_every_heartbeat(const Peer& p) const {
  return peers_.size() <= witnesses || interval_from(p) <= heartbeat_interval / 2;
}

/// The nearest that are alive.
void Fleet::choose_witnesses() {
  std::vector<std::pair<double, Peer*>> alive;
  alive.reserve(peers_.size());
  for (Peer& p : peers_) {
    p.is_witness = false;
    if (!p.failed) alive.emplace_back(gap(p), &p);
  }
  const std::size_t few = std::min(witnesses, alive.size());
  std::ranges::nth_element(alive, alive.begin() + static_cast<std::ptrdiff_t>(few));
  for (std::size_t k = 0; k < few; ++k) {
    alive[k].second->is_witness = true;
    told_from_[static_cast<std::size_t>(alive[k].second - peers_.data())] = 0;
  }
  chosen_among_ = peers_.size();
}

Fleet::Address Fleet::address(std::uint32_t tick, const RoundId* news, const RobotName& waits_for,
                              double now) {
  if (!own_mission_) return {};
  if (is_tick_of(0, tick, ticks_per_choice) || peers_.size() != chosen_among_) choose_witnesses();
  const auto awaited = index_.find(waits_for);
  std::vector<Peer*> addressed;
  addressed.reserve(peers_.size());
  const bool tells_of_a_round = news != nullptr || waits_in_.epoch > 0;
  for (std::size_t k = 0; k < peers_.size(); ++k) {
    const bool is_awaited = k == awaited;
    if (tick < told_from_[k] && !tells_of_a_round && !is_awaited) continue;  // nearly always
    Peer& p = peers_[k];
    const bool in_round = news != nullptr && p.state && (news->includes(p.place) || p.state->round == *news);
    if (in_round || is_awaited || is_told(k, tick, now)) addressed.push_back(&p);
  }
  Address to{.agents = {}, .echoes = next_echoes(addressed, tick), .misses = next_missing()};
  to.agents.reserve(addressed.size());
  for (const Peer* p : addressed) to.agents.push_back(p->robot);
  return to;
}

/// Strangers, of whom a fleet that begins has many, hear of it until they are none.
std::vector<RobotName> Fleet::who_hears_copies(std::span<const RobotName> agents) const {
  std::vector<RobotName> those;
  those.reserve(agents.size());
  for (const RobotName& robot : agents) {
    const auto known = index_.find(robot);
    if (known && (peers_[*known].is_witness || is_synchronised(peers_[*known]))) those.push_back(robot);
  }
  return those;
}

/// It says something itself, and of late, for its distance.
bool Fleet::hears(const Peer& p, double now) const {
  return p.state && !p.state->passed_on && !p.failed && unheard(p, now) < relay_from * second();
}

/// Somebody is heard here whom that one misses: the next state says so, but no two shortly after each other,
/// for those who answer may miss somebody, too.
bool Fleet::answers(const RobotState& state, std::size_t asker, double now) {
  if (!own_mission_ || state.passed_on) return false;
  peers_[asker].is_ignorant = std::ranges::find(state.misses, self_) != state.misses.end();
  bool tells = false;
  const bool is_due = now >= answered_until_[asker];
  for (const RobotName& missed : state.misses) {
    const auto known = index_.find(missed);
    if (!known || !hears(peers_[*known], now)) continue;
    peers_[asker].is_ignorant = tells = true;
    const bool noted = std::ranges::find(missed_by_others_, *known) != missed_by_others_.end();
    if (is_due && !noted && missed_by_others_.size() < most_answers) missed_by_others_.push_back(*known);
  }
  if (!is_due || !tells) return false;
  answered_until_[asker] = now + between_answers * second();
  return true;
}

/// Who is not failed at every tick, where they are not too many. The places to go on from are odd in number:
/// so those who hear every second, fourth, ... state hear of all.
std::vector<RobotName> Fleet::next_missing() {
  std::vector<RobotName> names;
  for (const auto* some : {&missing_, &silent_failed_}) {
    const std::size_t size = some->size();
    for (std::size_t k = 0; k < size && names.size() < most_missed; ++k) {
      const std::size_t next = size <= most_missed ? k : (asked_for_ + k) % (size | 1);
      if (next < size) names.push_back(peers_[(*some)[next]].robot);
    }
  }
  asked_for_ += most_missed;
  return names;
}

/// Of those whom others miss; for those who ask for one, or have none yet, and now and then for those who
/// will not hear of the next ones; from time to time whatever else is news.
std::vector<Echo> Fleet::next_echoes(std::span<Peer* const> addressed, std::uint32_t tick) {
  std::vector<Echo> echoes;
  const auto echo_of = [&](const Peer& p) {
    return Echo{p.robot, p.state->stamp, clock_.fleet_time(p.heard_at)};
  };
  const auto add = [&](Peer& p) {
    if (echoes.empty()) echoes.reserve(echoes_a_state);  // most states have none, and are kept for long
    p.echo_sent = p.state->stamp;
    p.asks = false;
    echoes.push_back(echo_of(p));
  };
  for (const std::size_t missed : std::exchange(missed_by_others_, {}))
    echoes.push_back(echo_of(peers_[missed]));
  const std::size_t most_news = echoes.size() + echoes_a_state;
  for (std::size_t k = 0; k < addressed.size() && echoes.size() < most_echoes; ++k) {
    Peer* p = addressed[(tick + k) % addressed.size()];
    if (!p->state) continue;
    const bool in_time = p->interval < rare || p->state->stamp - p->echo_sent < between_echoes;
    if (in_time && is_synchronised(*p) && !p->asks) continue;
    add(*p);
    p->handshakes += p->clock.known();
  }
  const bool all_news = is_tick_of(0, tick, ticks_per_echo);
  for (std::size_t k = 0; all_news && k < peers_.size() && echoes.size() < most_news; ++k) {
    next_echo_ = next_echo_ + 1 < peers_.size() ? next_echo_ + 1 : 0;
    Peer& p = peers_[next_echo_];
    if (p.state && p.echo_sent != p.state->stamp) add(p);
  }
  return echoes;
}

}  // namespace coppice
