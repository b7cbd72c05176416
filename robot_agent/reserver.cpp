#include "robot_agent/reserver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "messages/validation.h"
#include "motion/space_time.h"
#include "robot_agent/limits.h"
#include "robot_agent/reservation_pair.h"
#include "robot_agent/timing.h"
#include "robot_agent/turn.h"

namespace coppice {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double lead = 2 * control_period;  // between the plan and the departure
constexpr double recent_state = Timing::recent_state;
constexpr double same_place = 0.01;  // metres between where a plan begins and where the robot stands
constexpr double same_time = 1e-6;   // seconds: rounding
constexpr double close_radii = 3;    // between robots that may fear each other's next move

bool may_plan(const FleetMember& m) {
  return !m.failed && !m.wants_to_stay && m.stage != Stage::waiting;
}
/// The robot waits for its turn.
bool is_wish(const ReservationMessage& r) {
  return r.trajectory.empty() && r.way > 0;
}
bool plans_first(const ReservationMessage& a, const ReservationMessage& b) {
  return plans_first(a.turn, a.way, a.robot, b.turn, b.way, b.robot);
}

}  // namespace

/// Numbers grow, also over restarts of the process.
std::uint32_t Reserver::next_number(double now) {
  number_ = std::max(number_ + 1, static_cast<std::uint32_t>(std::max(0.0, now) / control_period) + 1);
  return number_;
}

void Reserver::say(ReservationMessage message, const FleetMember& self, double now,
                   std::vector<Outgoing>& out) {
  message.robot = robot_;
  message.radius = self.radius;
  message.number = next_number(now);
  message.run = run_;
  out.emplace_back(std::move(message));
}

void Reserver::want(const Path& path, const FleetMember& self, const ClearanceField& field, double now,
                    std::vector<Outgoing>& out) {
  const Wanted wanted{is_urgent_ ? Turn::urgent : turn_of(path, self.radius, field), length_of(path), now};
  say({.robot = {}, .way = wanted.way, .turn = wanted.turn, .run = {}}, self, now, out);
  state_ = wanted;
}

/// Another robot may count on the strip if this robot has told it that it heeds its reservation.
void Reserver::leave_strip(const Fleet& fleet, double now) {
  const auto* const held = std::get_if<Held>(&state_);
  if (held == nullptr) return;
  for (const auto& [robot, told] : told_) {
    const ReservationMessage* const r = others_->find(robot, run_);
    const bool heeds = r != nullptr && told.number == r->number && !r->trajectory.empty();
    if (heeds && come_near(*held->own, *r))
      rely_on_strip_.push_back({robot, now + recent_state + fleet.longest_braking() + lead});
  }
}

/// The process before this one may have held a reservation.
void Reserver::begin_anew(const Fleet& fleet, double last_state, double now) {
  state_ = nothing;
  number_ = next_number(now);
  waits_for_.clear();
  is_news_ = true;
  rely_on_strip_.clear();
  if (fleet.size_of_the_run() < 2) return;
  // Without a name: it is not known who relies on it.
  rely_on_strip_.push_back({RobotName(), last_state + recent_state + fleet.longest_braking() + lead});
}

/// A robot that says that it has heard may still brake on a line for which it relied on the strip. It does
/// not matter if the two are too far apart to meet before that is over.
bool Reserver::may_leave_strip(const FleetMember& self, const Fleet& fleet, double now) {
  const auto concerns = [&](Relies& other) {
    const auto m = fleet.find(other.robot, now);
    if (now >= other.until || (m && m->failed)) return false;
    if (!m || m->limits.max_speed == 0) return true;  // nothing is known of where it is
    const auto knows = knows_this_.find(other.robot);
    if (!other.has_heard && knows != knows_this_.end() && knows->second >= number_)
      other = {other.robot, std::min(other.until, now + fleet.longest_braking() + lead), true};
    const double age = now - m->promise.stamp + m->clock_error;
    const double gap = (m->promise.position - self.position).norm() - self.radius - m->radius;
    return gap <= m->max_speed * age + (m->max_speed + self.limits.max_speed) * (other.until - now);
  };
  // All are looked at: each notes when the other robot has heard.
  const auto concerned = std::ranges::count_if(rely_on_strip_, concerns);
  if (concerned == 0) rely_on_strip_.clear();
  return concerned == 0;
}

void Reserver::hear(const RobotState& state) {
  for (const ReservationId& known : state.knows) {
    if (known.robot == robot_) knows_this_[state.robot] = std::max(knows_this_[state.robot], known.number);
  }
}

/// Each number is told to its robot several times, and then from time to time.
std::vector<ReservationId> Reserver::knows(std::span<const RobotName> robots) {
  std::vector<ReservationId> known;
  for (std::size_t k = 0; k < robots.size() && known.size() < most_known_reservations; ++k) {
    const RobotName& robot = robots[(next_told_ + k) % robots.size()];
    const ReservationMessage* const r = others_->find(robot, run_);
    if (r == nullptr) continue;
    Told& told = told_[robot];
    if (told.number != r->number) told = {r->number, 0};
    ++told.times;
    if (told.times > 10 && told.times % 16 != 0) continue;
    known.push_back({robot, r->number});
  }
  next_told_ += most_known_reservations;
  return known;
}

void Reserver::drop(const FleetMember& self, const Fleet& fleet, double now, std::vector<Outgoing>& out) {
  if (std::holds_alternative<None>(state_) && !std::exchange(is_news_, false)) return;
  if (holds() && finished()) is_urgent_ = false;
  leave_strip(fleet, now);
  say({.robot = {}, .run = {}}, self, now, out);
  state_ = nothing;
  waits_for_.clear();
}

bool Reserver::may_try(double now) const {
  const auto* const none = std::get_if<None>(&state_);
  return none != nullptr &&
         now - none->tried_at >=
             (others_->news() != none->news ? Timing::reserve_again : Timing::reserve_again_without_news);
}

/// The robot whose turn it is, as far as this robot knows. Empty: a robot of which nothing was heard.
RobotName Reserver::next_to_plan(const Wanted& wanted, const Fleet& fleet) const {
  const ReservationMessage own{.robot = robot_, .way = wanted.way, .turn = wanted.turn, .run = {}};
  const ReservationMessage* next = &own;
  for (const FleetMember& m : fleet.others()) {
    if (!may_plan(m) || wanted.passed_over.contains(m.robot)) continue;
    const ReservationMessage* const r = others_->find(m.robot, run_);
    if (r == nullptr && !wanted.passed_over.contains({})) return {};
    if (r != nullptr && is_wish(*r) && plans_first(*r, *next)) next = r;
  }
  return next->robot;
}

bool Reserver::is_turn(Wanted& wanted, const Fleet& fleet, double now) const {
  for (;;) {
    const RobotName next = next_to_plan(wanted, fleet);
    if (next == robot_) return true;
    if (wanted.next && *wanted.next != next) wanted.since = now;
    wanted.next = next;
    if (now - wanted.since <= Timing::longest_turn * fleet.second()) return false;
    wanted.passed_over.insert(next);
  }
}

void Reserver::plan(const Path& path, double ready, const FleetMember& self, const Limits& limits,
                    const Fleet& fleet, MapRoadmaps& places, double now, std::vector<Outgoing>& out) {
  auto* const wanted = std::get_if<Wanted>(&state_);
  if (wanted == nullptr || !self.stands || !is_turn(*wanted, fleet, now)) return;
  const double begin = std::max(now + lead, ready) + speeding_up(limits);
  TrajectoryPlanner planner(places, path, self.radius, limits, begin, others_to_reckon_with(fleet, now),
                            fleet.zones_of_failed(self.position, now));
  auto found = planner.around_all();
  if (!found) {
    is_urgent_ = true;
    found = planner.around_most();
  }
  if (!found) {
    drop(self, fleet, now, out);
    state_ = None{now, others_->news()};
    return;
  }
  hold({.robot = robot_,
        .radius = self.radius,
        .way = wanted->way,
        .trajectory = *std::move(found),
        .basis = planner.basis(),
        .turn = is_urgent_ ? Turn::urgent : wanted->turn,
        .run = run_},
       now, out);
}

/// Those that wait for their turn set off one after the other: each reservation must reach the next one.
std::vector<OtherRobot> Reserver::others_to_reckon_with(const Fleet& fleet, double now) const {
  const std::vector<FleetMember> members = fleet.others();
  std::vector<const ReservationMessage*> queue;
  for (const FleetMember& m : members) {
    const ReservationMessage* const r = others_->find(m.robot, run_);
    if (may_plan(m) && r != nullptr && is_wish(*r)) queue.push_back(r);
  }
  std::ranges::sort(queue, [](const auto* a, const auto* b) { return plans_first(*a, *b); });
  const double turn = 2 * fleet.clock_error(now);  // about the time there and back
  std::vector<OtherRobot> others;
  for (const FleetMember& m : members) {
    if (m.failed) continue;
    const auto before = std::ranges::find(queue, others_->find(m.robot, run_)) - queue.begin();
    const double sets_off = now + Timing::sets_off_within + turn * static_cast<double>(before);
    others.push_back({.position = m.position,
                      .radius = m.radius,
                      .reservation = reservation_of(m),
                      .stands_until = m.wants_to_stay ? infinity : sets_off});
    if (!others.back().reservation) continue;
    const ReservationMessage& r = *others_->find(m.robot, run_);
    others.back().may_give_way = !m.wants_to_stay && !is_of_plan(r) && r.turn != Turn::urgent;
  }
  return others;
}

/// The other robot drives on from where it is, as late as it is: gates hold it up, or its trajectory was
/// planned around somebody that has gone. It does not come again where it has been.
std::optional<KnownReservation> Reserver::reservation_of(const FleetMember& m) const {
  const ReservationMessage* const r = others_->find(m.robot, run_);
  const bool keeps_to_it =
      r != nullptr && !r->trajectory.empty() && m.reservation <= r->number && m.stage != Stage::waiting;
  if (!keeps_to_it) return std::nullopt;
  KnownReservation known{{m.robot, r->number, m.clock_offset}, r->trajectory, r->radius};
  if (m.reservation == r->number) {
    known.trajectory = rest_of(r->trajectory, m.reservation_progress);
    const double late = m.promise.turn - (known.trajectory.front().time + m.clock_offset);
    if (late > room_in_time) known.basis.offset += late;
  }
  known.trajectory = shifted(std::move(known.trajectory), known.basis.offset);
  return known;
}

/// From now on the robot drives by this reservation. The message has all but its number.
Reserver::Held& Reserver::hold(ReservationMessage message, double now, std::vector<Outgoing>& out) {
  std::erase_if(message.basis, [&](const ReservationBasis& b) {
    const ReservationMessage* const r = others_->find(b.robot, run_);
    return r == nullptr || r->trajectory.empty() || !come_near(message, *r);
  });
  message.number = next_number(now);
  const std::vector<Path> legs = legs_of(path_of(message.trajectory));
  auto own = std::make_shared<const ReservationMessage>(std::move(message));
  out.emplace_back(*own);
  state_ = Held{own, WayFollower(legs, own->radius, reserved_stray_radii * own->radius)};
  return std::get<Held>(state_);
}

/// Until another member has taken up its own part, it counts as standing at the beginning of its way.
void Reserver::adopt(std::shared_ptr<const JointPlanMessage> plan, const FleetMember& self,
                     const Fleet& fleet, double now, std::vector<Outgoing>& out) {
  const auto part = std::ranges::find(plan->members, robot_, &JointPlanMessage::Member::robot);
  const bool has_part = part != plan->members.end() && path_of(part->trajectory).size() > 1 &&
                        (part->trajectory.front().position - self.position).norm() < same_place;
  is_news_ = true;
  if (!has_part) return drop(self, fleet, now, out);
  const auto leader = fleet.find(plan->round.leader);
  const double shift = leader ? leader->clock_offset : 0;
  ReservationMessage message{.robot = robot_,
                             .radius = self.radius,
                             .way = length_of(path_of(part->trajectory)),
                             .trajectory = shifted(part->trajectory, shift),
                             .basis = plan->basis,
                             .plan = {plan->round.leader, plan->round.epoch, shift},
                             .run = run_};
  for (ReservationBasis& b : message.basis) b.offset += shift;
  Held& held = hold(std::move(message), now, out);
  held.round = plan->round;
  for (const JointPlanMessage::Member& m : plan->members) {
    if (m.robot == robot_ || m.trajectory.empty()) continue;
    const ReservationMessage* const last = others_->find(m.robot, run_);
    if (last != nullptr && are_of_one_plan(*last, *held.own)) continue;  // the member took up its part first
    Pair& pair = held.pairs[m.robot];
    pair = {.number = last != nullptr ? last->number : 0, .is_awaited = true};
    pair.gates = Gates(order_of(part->trajectory, self.radius, m.trajectory, m.radius, 0).gates);
  }
}

/// Where two robots planned without each other, one of them plans again.
bool Reserver::is_overridden(const Fleet& fleet) {
  Held& held = std::get<Held>(state_);
  held.is_overridden = held.is_overridden || comes_too_close(fleet);
  return held.is_overridden;
}

bool Reserver::comes_too_close(const Fleet& fleet) {
  Held& held = std::get<Held>(state_);
  if (std::exchange(held.compared, others_->news()) == others_->news()) return false;
  const ReservationMessage& own = *held.own;
  return std::ranges::any_of(*others_, [&](const auto& known) {
    const ReservationMessage& other = *known.second;
    if (other.run != run_ || other.trajectory.empty() || !overrides(other, own)) return false;
    if (are_related(own, other) || !come_near(own, other)) return false;
    const auto m = fleet.find(other.robot);
    return m && !m->failed &&
           come_too_close(own.trajectory, shifted(other.trajectory, m->clock_offset),
                          kept_apart(own.radius, other.radius), own.trajectory.front().time);
  });
}

/// Takes up the order with robots whose reservations are new.
void Reserver::look_at_others(Held& held, const Fleet& fleet) const {
  if (std::exchange(held.news, others_->news()) == others_->news()) return;
  const ReservationMessage& own = *held.own;
  for (const auto& [robot, other] : *others_) {
    if (other->run != run_) continue;
    Pair& pair = held.pairs[robot];
    if (pair.number == other->number || (pair.is_awaited && other->trajectory.empty())) continue;
    pair = {.number = other->number};
    if (other->trajectory.empty()) continue;
    if (!come_near(own, *other)) {
      pair.is_related = true;
      continue;
    }
    const auto m = fleet.find(robot);
    const double offset = offset_between(own, *other, m ? m->clock_offset : 0);
    Order order = order_of(own.trajectory, own.radius, other->trajectory, other->radius, offset);
    Order theirs = order_of(other->trajectory, other->radius, own.trajectory, own.radius, -offset);
    pair.gates = Gates(std::move(order.gates));
    pair.theirs = std::move(theirs.gates);
    pair.is_related = are_related(own, *other);
    pair.apart_beyond = order.apart_beyond;
    pair.they_beyond = theirs.apart_beyond;
  }
}

/// Metres along its way that the robot has come at a time, at least. It may have begun to brake after its
/// promise.
double Reserver::First::progress_at(double time) const {
  const Promise& p = promise;
  const double t = time - clock_error;
  if (t < p.turn) return progress - (p.turn - t) * p.velocity.norm();
  double driven = (std::min(t, p.expiry) - p.turn) * p.next_velocity.norm();
  double speed = p.next_velocity.norm();
  for (double begin = p.expiry; begin < t && speed > 0; begin += control_period) {
    speed = std::max(0.0, speed - limits.max_acceleration * control_period);
    driven += speed * std::min(control_period, t - begin);
  }
  return progress + std::max(0.0, driven - slip);
}

/// Whether another robot does not go on by its reservation, and stands. A state may be older than a
/// reservation that came before it: numbers tell when a reservation was made (next_number).
bool Reserver::has_left(const Held& held, const Pair& pair, const FleetMember& m) {
  if (!m.stands) return false;
  const bool is_newer = m.promise.stamp - m.clock_offset >= control_period * pair.number;
  if (!pair.is_awaited) return m.reservation > pair.number || (is_newer && m.stage == Stage::waiting);
  if (m.round != held.round) return m.round.overrides(held.round);
  return m.stage != Stage::waiting && m.reservation == 0;
}

Point2 Reserver::preferred_velocity(const FleetMember& self, const Fleet& fleet, const Point2& position,
                                    const Limits& limits, double now) {
  Held& held = std::get<Held>(state_);
  look_at_others(held, fleet);
  const double slack = gate_slack_radii * self.radius;
  const double progress = held.follower.progress();
  held.first.clear();
  double open = infinity;
  const RobotName* next = nullptr;
  for (auto& [robot, pair] : held.pairs) {
    if (pair.gates.all_open()) continue;
    const auto m = fleet.find(robot, now);
    if (!m || m->failed || has_left(held, pair, *m)) continue;
    const bool drives = !pair.is_awaited && m->reservation == pair.number;
    const First first{&pair,
                      m->promise,
                      m->limits,
                      m->clock_error,
                      drives ? m->reservation_progress : 0,
                      2 * reserved_stray_radii * m->radius};
    const double passed = drives ? m->reservation_progress : 0;
    if (pair.gates.open(progress, slack, passed) == infinity) continue;
    held.first.push_back(first);
    const double certain = drives ? first.progress_at(infinity) : 0;
    const double until = pair.gates.open_if(progress, slack, certain);
    if (until >= open) continue;
    open = until;
    next = &robot;
    waits_until_ = std::max(now, m->rests_until) + pair.gates.metres_until(until, certain) / m->max_speed;
  }
  const Point2 wanted = held.follower.preferred_velocity(position, limits, control_period, open);
  own_speed_ = std::min(limits.max_speed, self.velocity.norm() + limits.max_acceleration * control_period);
  own_limits_ = limits;
  waits_for_ = next != nullptr && open - held.follower.progress() < slack ? *next : RobotName();
  return wanted;
}

bool Reserver::allows(const Driver& body, const Point2& velocity) const {
  const Held& held = std::get<Held>(state_);
  const double slack = gate_slack_radii * body.radius();
  const double begin = held.follower.progress();
  Point2 here = body.turn_position();
  Point2 v = velocity;
  double along = begin;
  for (double t = body.time() + control_period; !v.isZero(0); t += control_period) {
    const Point2 next = here + control_period * v;
    const auto comes_to = held.follower.along_strip(here, next, along);
    if (!comes_to) return false;
    for (const First& first : held.first) {
      if (!first.pair->is_related) continue;
      const double certain = first.progress_at(t);
      for (const Gate& gate : first.pair->gates.left()) {
        if (gate.at >= *comes_to - 1e-9) break;
        // Near the end of a leg the robot counts as being there, so as a little further than it is.
        if (gate.at >= begin - 2 * slack && certain < gate.needed - slack) return false;
      }
    }
    here = next;
    along = *comes_to;
    v = braked(v, body.limits(), control_period);
  }
  return true;
}

/// Until both are sure to know each other's reservation, one may have passed a gate that is closed to it.
/// From then on neither does.
void Reserver::confirm(const RobotState& other) {
  auto* const held = std::get_if<Held>(&state_);
  if (held == nullptr || other.reservation == 0 || other.stage == Stage::waiting || other.passed_on) return;
  const auto known = held->pairs.find(other.robot);
  if (known == held->pairs.end() || known->second.is_confirmed || !known->second.is_related ||
      known->second.number != other.reservation)
    return;
  Pair& pair = known->second;
  const bool apart =
      held->follower.progress() > pair.apart_beyond || other.reservation_progress > pair.they_beyond;
  const auto knows = knows_this_.find(other.robot);
  if (!apart || knows == knows_this_.end() || knows->second != held->own->number) return;
  const auto passed_closed = [](std::span<const Gate> gates, double committed, double others_progress,
                                double slack) {
    const auto closed =
        std::ranges::find_if(gates, [&](const Gate& gate) { return gate.needed - slack > others_progress; });
    return closed != gates.end() && closed->at < committed - 1e-6;
  };
  const double slack = gate_slack_radii * std::min(held->own->radius, other.radius);
  const auto committed = [&](double progress, double speed, const Limits& limits) {
    return progress + control_period * speed + braking_distance(speed, limits, control_period);
  };
  const double theirs =
      committed(other.reservation_progress, other.promise.next_velocity.norm(), limits_of(other));
  const double own = committed(held->follower.progress(), own_speed_, own_limits_);
  pair.is_confirmed = !passed_closed(pair.theirs, theirs, held->follower.progress(), slack) &&
                      !passed_closed(pair.gates.all(), own, other.reservation_progress, slack);
}

bool Reserver::passes(const RobotState& other, double age) {
  const auto* const held = std::get_if<Held>(&state_);
  if (held == nullptr || age > recent_state || other.reservation == 0 || other.stage == Stage::waiting)
    return false;
  const auto known = held->pairs.find(other.robot);
  const ReservationMessage* const latest = others_->find(other.robot, run_);
  const bool is_latest = latest != nullptr && latest->number == other.reservation;
  if (!is_latest || known == held->pairs.end() || known->second.number != other.reservation) return false;
  if (!known->second.is_confirmed) confirm(other);
  return known->second.is_confirmed;
}

void Reserver::doubt_all() {
  if (auto* const held = std::get_if<Held>(&state_)) {
    for (auto& [robot, pair] : held->pairs) pair.is_confirmed = false;
  }
}

bool Reserver::gives_way(const FleetMember& self, const Fleet& fleet) const {
  const Held& held = std::get<Held>(state_);
  const double own = rest_of(held.own->trajectory, held.follower.progress()).front().time;
  for (const FleetMember& m : fleet.beside(self.position, self.radius, close_radii)) {
    const ReservationMessage* const known = others_->find(m.robot, run_);
    if (m.failed || known == nullptr || known->trajectory.empty() || m.reservation != known->number) continue;
    const auto pair = held.pairs.find(m.robot);
    const bool is_confirmed = pair != held.pairs.end() && pair->second.is_confirmed;
    if (is_confirmed || m.wants_to_stay || !m.waits_for.empty()) continue;
    const double later = rest_of(known->trajectory, m.reservation_progress).front().time +
                         offset_between(*held.own, *known, m.clock_offset) - own;
    if (later < -same_time || (later < same_time && m.robot < robot_)) return true;
  }
  return false;
}

bool Reserver::is_worth_waiting(const Fleet& fleet, double now) {
  RobotName last = waits_for_;
  auto m = fleet.find(last);
  for (std::size_t hops = 0; m && !m->waits_for.empty() && hops < 1000; ++hops) {
    if (m->waits_for == robot_) return false;
    last = m->waits_for;
    m = fleet.find(last);
  }
  if (!m || m->failed) return false;
  if (last != awaited_ || m->reservation_progress != awaited_progress_ || m->stage == Stage::waiting) {
    awaited_ = last;
    awaited_progress_ = m->reservation_progress;
    awaited_since_ = now;
  }
  return now - awaited_since_ < Timing::longest_wait_at_gate;
}

}  // namespace coppice
