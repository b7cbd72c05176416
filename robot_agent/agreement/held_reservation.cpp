#include "robot_agent/agreement/held_reservation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "motion/trajectory/space_time.h"
#include "robot_agent/agreement/reservation_pair.h"
#include "robot_agent/limits.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double same_time = 1e-6;  // seconds: rounding
constexpr double close_radii = 3;   // between robots that may fear each other's next move

/// A robot that comes so far for sure has passed a gate that is closed to it. `others_progress`: of the robot
/// for which it is to wait.
bool passed_closed(std::span<const Gate> gates, double committed, double others_progress, double slack) {
  const auto closed =
      std::ranges::find_if(gates, [&](const Gate& gate) { return gate.needed - slack > others_progress; });
  return closed != gates.end() && closed->at < committed - 1e-6;
}

/// Whether the first leg of what is left of a way leads into another robot where that is now.
bool leads_into(const Trajectory& rest, const Point2& other, double radii) {
  const Point2& from = rest.front().position;
  const auto next = std::ranges::find_if(rest, [&](const TimedPoint& p) { return p.position != from; });
  if (next == rest.end()) return false;
  const Point2 leg = next->position - from;
  const Point2 heading = leg.normalized();
  const double ahead = heading.dot(other - from);
  const double beside = (other - from - ahead * heading).norm();
  return ahead > 0 && beside < radii && leg.norm() > ahead - std::sqrt(radii * radii - beside * beside);
}

/// Metres along its way to which a robot comes at most, whatever it decides.
double committed(double progress, double speed, const Limits& limits, std::span<const Corner> corners) {
  const double driven = control_period * speed + braking_distance(speed, limits, control_period);
  return progress + driven + gained_at(corners, progress, progress + driven);
}

}  // namespace

HeldReservation::HeldReservation(std::shared_ptr<const ReservationMessage> own, const Limits& limits,
                                 const Reservations& others)
    : own_(std::move(own)),
      others_(&others),
      follower_(legs_of(path_of(own_->trajectory)), own_->radius, reserved_stray_radii * own_->radius),
      corners_(corners_of(path_of(own_->trajectory), reserved_stray_radii * own_->radius)),
      own_limits_(limits) {}

void HeldReservation::come_to(const Driver& body) {
  follower_.come_to(body.decision_position());
  own_speed_ = body.velocity().norm();
  own_limits_ = body.limits();
}

Path HeldReservation::way() const {
  Path way = path_of(own_->trajectory);
  if (!rest_.empty()) way.insert(way.end(), rest_.begin() + 1, rest_.end());
  return way;
}

void HeldReservation::expect_members_of(const JointPlanMessage& plan) {
  round_ = plan.round;
  const auto part = std::ranges::find(plan.members, own_->robot, &JointPlanMessage::Member::robot);
  for (const JointPlanMessage::Member& m : plan.members) {
    if (m.robot == own_->robot || m.trajectory.empty()) continue;
    const ReservationMessage* const last = others_->find(m.robot, own_->run);
    if (last != nullptr && are_of_one_plan(*last, *own_)) continue;  // the member took up its part first
    Pair& pair = pairs_[m.robot];
    pair = {.number = last != nullptr ? last->number : 0, .is_awaited = true};
    pair.gates = Gates(order_of(part->trajectory, own_->radius, m.trajectory, m.radius, 0).gates);
  }
}

void HeldReservation::look_at_others(const Fleet& fleet) {
  if (std::exchange(news_, others_->news()) == others_->news()) return;
  for (const auto& [robot, other] : *others_) {
    if (other->run != own_->run) continue;
    Pair& pair = pairs_[robot];
    if (pair.number != other->number && !(pair.is_awaited && other->trajectory.empty()))
      pair = pair_with(*other, fleet);
    if (!pair.overrides) continue;
    const auto m = fleet.find(robot);
    is_overridden_ = is_overridden_ || (m && !m->failed);
  }
}

/// Where two robots planned without each other, one of them plans again.
HeldReservation::Pair HeldReservation::pair_with(const ReservationMessage& other, const Fleet& fleet) const {
  const ReservationMessage& own = *own_;
  Pair pair{.number = other.number};
  if (other.trajectory.empty()) return pair;
  pair.is_related = true;
  if (!come_near(own, other)) return pair;
  const auto m = fleet.find(other.robot);
  const double estimate = m ? m->clock_offset : 0;
  const double offset = offset_between(own, other, estimate);
  pair.offset = offset;
  Order order = order_of(own.trajectory, own.radius, other.trajectory, other.radius, offset);
  Order theirs = order_of(other.trajectory, other.radius, own.trajectory, own.radius, -offset);
  pair.gates = Gates(std::move(order.gates));
  pair.theirs = std::move(theirs.gates);
  pair.too_close = std::move(order.too_close);
  pair.too_close.insert(pair.too_close.end(), theirs.other_too_close.begin(), theirs.other_too_close.end());
  pair.they_beyond = std::max(beyond(theirs.too_close), beyond(order.other_too_close));
  pair.their_corners = corners_of(path_of(other.trajectory), reserved_stray_radii * other.radius);
  pair.is_related = are_related(own, other);
  if (pair.is_related || !overrides(other, own)) return pair;
  pair.overrides = come_too_close(own.trajectory, shifted(other.trajectory, estimate),
                                  kept_apart(own.radius, other.radius), own.trajectory.front().time);
  pair.is_to_be_named = !pair.overrides && keep_room(own.trajectory, own.radius,
                                                     shifted(other.trajectory, estimate), other.radius);
  return pair;
}

bool HeldReservation::has_unnamed() const {
  return std::ranges::any_of(pairs_, [](const auto& known) { return known.second.is_to_be_named; });
}

std::vector<ReservationBasis> HeldReservation::basis() const {
  std::vector<ReservationBasis> basis;
  for (const auto& [robot, pair] : pairs_) {
    const ReservationMessage* const other = others_->find(robot, own_->run);
    const bool is_known = other != nullptr && other->number == pair.number && !other->trajectory.empty();
    if (!is_known || are_of_one_plan(*own_, *other) || !come_near(*own_, *other)) continue;
    if (pair.is_related || pair.is_to_be_named) basis.push_back({robot, pair.number, pair.offset});
  }
  return basis;
}

void HeldReservation::renew(std::shared_ptr<const ReservationMessage> own) {
  own_ = std::move(own);
  // All others are taken up anew: whether they are related depends on the number and the basis.
  std::erase_if(pairs_, [](const auto& known) { return !known.second.is_awaited; });
  doubt_all(doubts_until_);
  news_ = ~std::uint32_t{0};
}

/// Metres along its way that the robot has come at a time, at least. It may have begun to brake after its
/// promise.
double HeldReservation::First::progress_at(double time) const {
  const Promise& p = promise;
  const double t = time - clock_error;
  if (t < p.decision_time) {
    const double before = progress - (p.decision_time - t) * p.velocity.norm();
    return before - gained_at(pair->their_corners, before, progress);
  }
  double driven = (std::min(t, p.expiry) - p.decision_time) * p.next_velocity.norm();
  double speed = p.next_velocity.norm();
  for (double begin = p.expiry; begin < t && speed > 0; begin += control_period) {
    speed = std::max(0.0, speed - limits.max_acceleration * control_period);
    driven += speed * std::min(control_period, t - begin);
  }
  return progress + std::max(0.0, driven - slip);
}

/// Whether another robot does not go on by its reservation, and stands. A state may be older than a
/// reservation that came before it: numbers tell when a reservation was made (Reserver::next_number).
bool HeldReservation::has_left(const Pair& pair, const FleetMember& m) const {
  if (!m.stands) return false;
  const bool is_newer = m.promise.stamp - m.clock_offset >= control_period * pair.number;
  if (!pair.is_awaited) return m.reservation > pair.number || (is_newer && m.stage == Stage::waiting);
  if (m.round != round_) return m.round.overrides(round_);
  return m.stage != Stage::waiting && m.reservation == 0;
}

double HeldReservation::open_before(std::span<const Neighbour> neighbours, double margin,
                                    const Limits& limits) const {
  if (margin == 0) return infinity;
  const double own_radius = own_->radius;
  const double braking =
      limits.max_speed * control_period + braking_distance(limits.max_speed, limits, control_period);
  double open = infinity;
  for (const Neighbour& n : neighbours) {
    if (!n.promise.stands()) continue;
    // A way that passes the other robot leads no closer, even where the robot strays from it.
    const double touching = own_radius + n.radius - reserved_stray_radii * own_radius;
    const double kept = own_radius + n.radius + margin;
    open = std::min(open, follower_.stop_before(n.promise.position, touching, kept, braking + kept));
  }
  return open;
}

void HeldReservation::look_at_gates(const Fleet& fleet, double now, double open) {
  look_at_others(fleet);
  const double slack = gate_slack_radii * own_->radius;
  first_.clear();
  const RobotName* next = nullptr;
  for (auto& [robot, pair] : pairs_) {
    if (pair.gates.all_open()) continue;
    const auto m = fleet.find(robot, now);
    if (!m || m->failed || has_left(pair, *m)) continue;
    const bool drives = !pair.is_awaited && m->reservation == pair.number;
    const First first{&pair,
                      m->promise,
                      m->limits,
                      m->clock_error,
                      drives ? m->reservation_progress : 0,
                      2 * reserved_stray_radii * m->radius};
    if (pair.gates.open(progress(), slack, drives ? first.progress_at(now) : 0) == infinity) continue;
    first_.push_back(first);
    const double certain = drives ? first.progress_at(infinity) : 0;
    const double until = pair.gates.open_if(progress(), slack, certain);
    if (until >= open) continue;
    open = until;
    next = &robot;
    const double speed = m->promise.next_velocity.norm();
    waits_until_ =
        std::max(now, m->rests_until) + least_time(pair.gates.metres_until(until, certain), speed, m->limits);
    longest_lease_ = std::max(Timing::longest_lease, braking_time(m->limits));
  }
  open_ = open;
  waits_for_ = next != nullptr && open - progress() < slack ? *next : RobotName();
  is_worth_waiting_ = !waits_for_.empty() && last_one_comes_on(fleet, now);
}

bool HeldReservation::allows(const Driver& body, const Twist& twist) const {
  const double slack = gate_slack_radii * body.radius();
  const double begin = progress();
  Point2 here = body.decision_position();
  Twist now = twist;
  double along = begin;
  for (double t = body.time() + control_period; !now.velocity.isZero(0); t += control_period) {
    const Point2 next = here + control_period * now.velocity;
    const auto comes_to = follower_.along_strip(here, next, along);
    if (!comes_to) return false;
    for (const First& first : first_) {
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
    now = braked(now, body.limits(), control_period);
  }
  return true;
}

/// Until both are sure to know each other's reservation, one may have passed a gate that is closed to it.
/// From then on neither does.
bool HeldReservation::may_be_confirmed(const Pair& pair, const RobotState& other) const {
  if (!pair.is_related || other.passed_on || !heeds_its_gates(pair, other, progress())) return false;
  const double slack = gate_slack_radii * std::min(own_->radius, other.radius);
  const double rest = comes_to_rest_at();
  return !passed_closed(pair.gates.all(), rest + gained_at(corners_, progress(), rest),
                        other.reservation_progress, slack);
}

/// Whether the other robot is before each gate that is closed to it if this one has come so far.
bool HeldReservation::heeds_its_gates(const Pair& pair, const RobotState& other, double own_progress) const {
  const double slack = gate_slack_radii * std::min(own_->radius, other.radius);
  const double theirs = committed(other.reservation_progress, other.promise.next_velocity.norm(),
                                  limits_of(other), pair.their_corners);
  return !passed_closed(pair.theirs, theirs, own_progress, slack);
}

/// Metres along its way at which the robot comes to rest if it brakes from its turn on. What it chooses
/// instead heeds its gates. Nobody counts on more.
double HeldReservation::comes_to_rest_at() const {
  return progress() + braking_distance(own_speed_, own_limits_, control_period);
}

/// Whether the robot stays, until it has braked after whatever it chooses next, where the trajectories keep
/// apart; or the other one is beyond all places where they do not.
bool HeldReservation::keeps_apart(const Pair& pair, double others_progress) const {
  // Rounding must not put a robot beyond a place where it stands, and where the two come too close.
  const double further = 2 * gate_slack_radii * own_->radius;
  if (others_progress > pair.they_beyond + further) return true;
  const double fastest =
      std::min(own_limits_.max_speed, own_speed_ + own_limits_.max_acceleration * control_period);
  const double comes_to = committed(progress(), fastest, own_limits_, corners_);
  return std::ranges::none_of(pair.too_close, [&](const Stretch& close) {
    return progress() <= close.end + further && comes_to >= close.begin - further;
  });
}

bool HeldReservation::passes(const RobotState& other, std::uint32_t heard, double said_at) {
  if (other.reservation == 0 || other.stage == Stage::waiting) return false;
  const auto known = pairs_.find(other.robot);
  const ReservationMessage* const latest = others_->find(other.robot, own_->run);
  const bool is_latest = latest != nullptr && latest->number == other.reservation;
  if (!is_latest || known == pairs_.end() || known->second.number != other.reservation) return false;
  Pair& pair = known->second;
  // The other one may have taken this robot for failed since, although this one never lost it.
  pair.is_confirmed =
      pair.is_confirmed ? heeds_its_gates(pair, other, comes_to_rest_at())
                        : said_at >= doubts_until_ && heard == own_->number && may_be_confirmed(pair, other);
  return pair.is_confirmed && keeps_apart(pair, other.reservation_progress);
}

void HeldReservation::doubt_all(double until) {
  doubts_until_ = until;
  for (auto& [robot, pair] : pairs_) pair.is_confirmed = false;
}

double HeldReservation::lease(double now) const {
  return std::clamp(waits_until_ - now, Timing::waiting_lease, longest_lease_);
}

bool HeldReservation::last_one_comes_on(const Fleet& fleet, double now) {
  RobotName last = waits_for_;
  auto m = fleet.find(last);
  for (std::size_t hops = 0; m && !m->waits_for.empty() && hops < 1000; ++hops) {
    if (m->waits_for == own_->robot) return false;
    last = m->waits_for;
    m = fleet.find(last);
  }
  if (!m || m->failed) return false;
  if (last != awaited_.robot || m->reservation_progress != awaited_.progress || m->stage == Stage::waiting)
    awaited_ = {last, m->reservation_progress, now};
  return now - awaited_.since < Timing::longest_wait_at_gate;
}

/// Whether only promises keep the robot apart from another one that goes first. If the way of just one of
/// them leads into the other one, that one goes first; else the one that is less far in time. Times are
/// compared in whole turns, seconds, and by the clock of the robot with the first name, so that both agree.
bool HeldReservation::goes_first(const FleetMember& m, double turn) const {
  const ReservationMessage* const theirs = others_->find(m.robot, own_->run);
  // A robot that has arrived may have a part in a joint plan that leads it out of the way.
  const bool goes_on = !m.wants_to_stay || m.stage == Stage::executing;
  const bool drives = theirs != nullptr && !theirs->trajectory.empty() && m.reservation == theirs->number &&
                      !m.failed && goes_on && m.waits_for.empty();
  if (!drives) return false;
  const auto pair = pairs_.find(m.robot);
  if (pair != pairs_.end() && pair->second.is_confirmed && keeps_apart(pair->second, m.reservation_progress))
    return false;
  const Trajectory own_rest = rest_of(own_->trajectory, progress());
  const Trajectory their_rest = rest_of(theirs->trajectory, m.reservation_progress);
  const double radii = own_->radius + m.radius;
  const bool is_behind = leads_into(own_rest, m.position, radii);
  if (is_behind != leads_into(their_rest, own_rest.front().position, radii)) return is_behind;
  const double offset = offset_between(*own_, *theirs, m.clock_offset);
  const bool is_first_by_name = m.robot < own_->robot;
  const auto turn_at = [&](const Trajectory& rest, double later) {
    return std::floor((rest.front().time + later) / turn);
  };
  const double own_turn = turn_at(own_rest, is_first_by_name ? -offset : 0);
  const double their_turn = turn_at(their_rest, is_first_by_name ? 0 : offset);
  return their_turn < own_turn || (their_turn == own_turn && is_first_by_name);
}

bool HeldReservation::leads_into_robot(const FleetMember& m) const {
  return leads_into(rest_of(own_->trajectory, progress()), m.position, own_->radius + m.radius);
}

bool HeldReservation::gives_way(const Point2& position, const Fleet& fleet) const {
  return std::ranges::any_of(fleet.beside(position, own_->radius, close_radii),
                             [&](const FleetMember& m) { return goes_first(m, same_time); });
}

/// Turns of a few seconds: or each robot would let the other one go as soon as it has moved a little.
double HeldReservation::lets_others_pass_for(const Driver& body, const Point2& wanted, const Fleet& fleet,
                                             bool stalls, double now) const {
  double seconds = 0;
  for (const FleetMember& m : fleet.beside(body.position(), body.radius(), close_radii, now)) {
    if (!goes_first(m, Timing::turn_of_passing)) continue;
    const double speed = m.promise.next_velocity.norm();
    const bool is_ahead = braking_time(m.limits) > Timing::longest_lease && leads_into_robot(m);
    const bool is_held_up = stalls && speed <= crawl(m.limits) &&
                            body.is_blocked_by({m.promise, m.radius, m.limits, m.clock_error}, wanted);
    if (!is_ahead && !is_held_up) continue;
    const double passes = Timing::waiting_lease + braking_time(m.limits);
    const double stops = speed / m.limits.max_acceleration;
    seconds = std::max(seconds, std::min(passes, stops + Timing::longest_lease));  // it may speed up
  }
  return seconds;
}

}  // namespace coppice
