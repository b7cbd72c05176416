#include <algorithm>
#include <optional>
#include <type_traits>
#include <variant>

#include "motion/body/keep_right.h"
#include "robot_agent/control/decision.h"
#include "robot_agent/control/progress_watch.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

constexpr double close_radii = 1.3;  // sums of radii between two of which one may let the other go first

const Driving* driving(const Situation& s) {
  return std::get_if<Driving>(&s.task);
}

/// The run and its tasks let the robot move, and it knows where all others are.
bool may_move(const Situation& s) {
  return !std::holds_alternative<Stopped>(s.task) && s.stage == Stage::free && s.may_set_off;
}

bool may_drive(const Situation& s) {
  return driving(s) != nullptr && !s.is_stranded && may_move(s);
}

/// Others count on its part of a joint plan, whatever its own task is.
bool carries_on(const Situation& s) {
  return s.executes_plan ? may_move(s) : may_drive(s);
}

/// Why a robot has no way of its own to drive.
Cause why_it_stays(const Situation& s) {
  if (std::holds_alternative<Planning>(s.task)) return Cause::planning;
  if (s.stage == Stage::waiting) return Cause::joint_plan;
  const bool is_under_way = driving(s) != nullptr || std::holds_alternative<DrivingOut>(s.task);
  if (is_under_way && !s.may_set_off) return Cause::startup;
  return driving(s) != nullptr && s.is_stranded ? Cause::stranded : Cause::idle;
}

/// What keeps the robot from moving at all: the first one counts. A new kind of hold is a line here.
std::optional<Cause> held_by(const Situation& s) {
  if (std::holds_alternative<Halted>(s.task)) return Cause::halted;
  if (s.joins) return Cause::joining;
  if (s.is_behind) return Cause::odometry;
  if (s.listens) return Cause::listening;
  if (!s.may_leave_strip) return Cause::strip;
  if (s.held == nullptr) return std::nullopt;
  if (s.held->is_overridden() || s.leads_elsewhere) return Cause::plans_anew;
  return carries_on(s) ? std::nullopt : std::optional(why_it_stays(s));
}

/// The robot takes a twist. If it stands then, it binds itself to that for some seconds, and longer where
/// states come late: they shorten what the others may use of the lease.
template <class Action>
void take_and_bind(Decision& d, const Action& otherwise, const Twist& next, double seconds,
                   const Situation& s) {
  d.action = otherwise;
  if (!s.body.velocity().isZero(0) || !next.velocity.isZero(0)) return;
  const double delay = std::min(s.fleet.clock_error(s.now), Timing::largest_clock_error);
  d.action = StandUntil{s.body.time() + seconds + Timing::lease_for_delay * delay, next.angular_velocity};
}

/// The body brakes. A robot in a strip that is about to know the others may set off at any moment.
Decision hold(Cause cause, const Situation& s) {
  Decision d{.cause = cause, .pauses_stall_clock = true};
  if (stands_until_let_go(cause) || s.may_set_off)
    take_and_bind(d, Brake{}, s.body.braking(), Timing::waiting_lease, s);
  return d;
}

/// The robot overlaps an obstacle a little. It plans once it has room.
Decision drive_out(const DrivingOut& out, const Situation& s) {
  Decision d{.cause = Cause::wall, .pauses_stall_clock = true};
  if (const auto next = s.body.driving_out(out.to, s.neighbours, s.field)) {
    d.action = Follow{*next};
  } else {
    take_and_bind(d, Brake{}, s.body.braking(), Timing::waiting_lease, s);
  }
  return d;
}

/// Seconds for which the robot lets others go first that may be held up, too; 0: not at all. Who goes is
/// agreed at once, and kept to after `stall`.
double gives_way_for(const HeldReservation& held, const Point2& wanted, double held_up_for,
                     const Situation& s) {
  const double slowly = std::min(1.0, crawl(s.body.limits()) / std::max(wanted.norm(), 1e-9));
  const double lease =
      held.lets_others_pass_for(s.body, slowly * wanted, s.fleet, held_up_for > stall, s.now);
  const bool may_agree = held_up_for > Timing::waiting_lease && held_up_for <= stall;
  if (lease > 0 || !may_agree || s.body.bound_to_stand()) return lease;
  return held.gives_way(s.body.position(), s.fleet) ? Timing::waiting_lease : 0;
}

Decision follow_reservation(const HeldReservation& held, const Situation& s) {
  const Driver& body = s.body;
  // Faster, a differential robot would come to the edge of its strip, stop, and turn back on the spot.
  const Point2 wanted = body.slow_to_turn(held.preferred_velocity(body.decision_position(), body.limits()),
                                          reserved_stray_radii * body.radius());
  const auto allowed = [&](const Twist& m) { return held.allows(body, m); };
  const Driver::Followed led = body.following(wanted, s.neighbours, s.field, allowed);
  const bool waits = !held.waits_for().empty();
  Decision d{.action = Follow{led.next},
             .cause = waits ? Cause::gate : Cause::promise,
             .pauses_stall_clock = waits && held.is_worth_waiting(),
             .comes_on = waits || led.next.velocity.norm() > crawl(body.limits()),
             .is_led = led.is_led};
  // A slow robot must not see the lease run out while it passes.
  double lease = waits ? held.lease(s.now) : 0;
  if (s.neighbours.empty() && !(body.bound_to_stand() && lease > Timing::longest_lease)) lease = 0;
  if (lease > 0) take_and_bind(d, Follow{led.next}, led.next, lease, s);
  // Several robots may keep clear of each other's next moves: one of them must go.
  const double held_up_for = d.comes_on ? 0 : s.now - s.last_moved;
  const bool is_held_up = held_up_for > Timing::waiting_lease;
  if (!is_held_up && s.fleet.longest_braking() <= Timing::longest_lease) return d;
  const double passes = gives_way_for(held, wanted, held_up_for, s);
  const bool stands = std::holds_alternative<StandUntil>(d.action);
  if (passes > 0) take_and_bind(d, Brake{}, body.braking(), stands ? std::max(lease, passes) : passes, s);
  return d;
}

/// The robot has no reservation. It stands, and evades where others want to pass.
Decision wait_to_reserve(const Situation& s) {
  const Twist next = s.body.evading(Point2::Zero(), s.neighbours, s.field);
  Decision d{.action = Evade{next}, .cause = Cause::reservation, .pauses_stall_clock = s.waits_for_its_turn};
  // Others that set off before it may pass closely, however late its states reach them.
  if (s.waits_for_its_turn) take_and_bind(d, Evade{next}, next, 0, s);
  return d;
}

/// Of robots that are held up close to each other, those go first that carry out a joint plan, and then the
/// one with the lowest name.
bool lets_others_go_first(const Situation& s) {
  const auto close = s.fleet.beside(s.body.position(), s.body.radius(), close_radii);
  return std::ranges::any_of(close, [&](const FleetMember& m) {
    const bool goes_on = !m.wants_to_stay || m.stage == Stage::executing;
    return !m.failed && goes_on && (m.reservation != 0 || m.robot < s.robot);
  });
}

/// The robot drives without a reservation, and keeps clear of the others by reciprocal velocity obstacles.
Decision follow_path(const PathFollower& follower, const Situation& s) {
  const Driver& body = s.body;
  const Point2 from = body.decision_position();
  const Point2 preferred = follower.preferred_velocity(from, body.limits(), control_period);
  const Twist next = body.evading(keeping_right(preferred, from, s.neighbours), s.neighbours, s.field);
  Decision d{.action = Follow{next},
             .cause = Cause::promise,
             .comes_on = next.velocity.norm() > crawl(body.limits())};
  const bool turns = body.velocity().isZero(0) && next.velocity.isZero(0) &&
                     (body.angular_velocity() != 0 || next.angular_velocity != 0);
  // Several robots may keep clear of each other's next moves: one of them must go.
  const bool is_held_up = !d.comes_on && !turns && s.now - s.last_moved > Timing::waiting_lease;
  if (body.bound_to_stand() || !is_held_up || !lets_others_go_first(s)) return d;
  const Twist slower = body.following(Point2::Zero(), s.neighbours, s.field).next;
  take_and_bind(d, Follow{slower}, slower, Timing::waiting_lease, s);
  return d;
}

/// Seconds for which a robot with no reason to move binds itself. A robot that brakes for long may only be as
/// fast as it can stop while the others are bound, so these leases grow with its speed.
double idle_lease(const Fleet& fleet) {
  const bool all_brake_soon = fleet.longest_braking() <= Timing::idle_lease / 2;
  return all_brake_soon ? Timing::idle_lease
                        : std::max(Timing::idle_lease, fleet.longest_stop() + Timing::idle_lease / 2);
}

/// A robot that the joint plan cannot help stands out of the others' way until they are done. A robot that
/// plans, or waits for news of the others, may set off at any moment.
Decision stay(const Situation& s) {
  const Twist next = s.body.evading(Point2::Zero(), s.neighbours, s.field);
  const Cause cause = why_it_stays(s);
  Decision d{.action = Evade{next}, .cause = cause, .pauses_stall_clock = true};
  const bool sets_off_soon = std::holds_alternative<Planning>(s.task) ||
                             std::holds_alternative<DrivingOut>(s.task) ||
                             (driving(s) != nullptr && !s.may_set_off);
  const double lease = s.stage == Stage::free ? idle_lease(s.fleet) : Timing::waiting_lease;
  if (!sets_off_soon) take_and_bind(d, Evade{next}, next, lease, s);
  return d;
}

Decision choose(const Situation& s) {
  if (const auto cause = held_by(s)) return hold(*cause, s);
  const auto* const out = std::get_if<DrivingOut>(&s.task);
  if (out != nullptr && may_move(s)) return drive_out(*out, s);
  if (s.held != nullptr) return follow_reservation(*s.held, s);
  if (!may_drive(s)) return stay(s);
  return reserves(s.coordination) ? wait_to_reserve(s) : follow_path(driving(s)->route.follower, s);
}

}  // namespace

Decision decide(const Situation& s) {
  Decision d = choose(s);
  const bool stands = s.body.velocity().isZero(0) && next_twist(d, s.body).velocity.isZero(0);
  if (!s.faces || !stands) return d;
  const Twist turning = s.body.facing(*s.faces);
  if (auto* const bound = std::get_if<StandUntil>(&d.action)) {
    bound->angular_velocity = turning.angular_velocity;
  } else {
    d.action = Follow{turning};
  }
  return d;
}

bool drives(const Situation& s) {
  return !held_by(s) && (s.held != nullptr || may_drive(s));
}

Twist next_twist(const Decision& decision, const Driver& body) {
  return std::visit(
      [&]<class Action>(const Action& action) -> Twist {
        if constexpr (requires { action.next; }) return action.next;
        if constexpr (std::is_same_v<Action, StandUntil>) return {Point2::Zero(), action.angular_velocity};
        return body.braking();
      },
      decision.action);
}

}  // namespace coppice
