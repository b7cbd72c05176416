// Part of class Run: a control step. The robot brings its body up to the present, listens, drives,
// and tells the others.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "robot_agent/control/run.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

// Timeouts: see timing.h.
constexpr double longest_ignorance = Timing::longest_ignorance;
constexpr double least_ignorance = Timing::least_ignorance;
constexpr double asks_for_news = Timing::asks_for_news;

constexpr double decisions_counted = 16;  // of those that may be late: a pause is one

}  // namespace

/// Brings the body up to the present, and decides once for the newest period.
void Run::control(double now, std::vector<Outgoing>& out) {
  if (now < body_.time()) return;
  bool due = std::exchange(timing_.first, false);
  // The journal begins with the first state, and so does the track.
  if (due && now - body_.time() >= control_period) pass_over(now);
  if (now - body_.time() > listening_time()) connectivity_.stand_until(now + listening_time());
  if (now - body_.time() > Timing::longest_nap * fleet_.second()) wake(now);
  const std::uint32_t next_heartbeat = counter_.next_heartbeat();
  int periods = 0;
  while (body_.time() + control_period <= now) {
    if (body_.stands() && now - body_.time() > longest_sleep) {
      pass_over(now);
      continue;
    }
    ++periods;
    if (!tracking_ && records(now)) track_.add(point_of(body_));
    status_.driven_length += control_period * body_.velocity().norm();
    body_.advance();
    reserver_.come_to(body_);
    trail_.go_on(body_.position(), map_->field, body_.radius());
    counter_.count_period(body_.stands() || !due, next_heartbeat);
    due = true;
  }
  if (!due) return;

  AgentLoad& load = process_.load;
  load.periods += static_cast<std::uint32_t>(periods);
  load.periods_missed += static_cast<std::uint32_t>(std::max(0, periods - timing_.periods_expected));
  timing_.late += ((periods > timing_.periods_expected ? 1 : 0) - timing_.late) / decisions_counted;
  decide(now, out);
  watch_movement(now, periods * control_period);
  const bool heartbeat = counter_.take_heartbeat();
  speak(now, heartbeat, out);
  if (heartbeat) relay_states(now, out);
  if (auto plan = round_.take_own_plan()) {
    plan->run = mission_.clock.run();
    out.emplace_back(*std::move(plan));
  }
  timing_.periods_expected = periods_to_next_control();
}

/// The body stood all that time, and goes on standing now.
void Run::pass_over(double now) {
  body_ = Driver(body_.position(), std::floor(now / control_period) * control_period, body_.radius(),
                 body_.limits(), control_period, body_.yaw());
}

/// After a long sleep, which is like a restart: others count on moves of a joint plan that is over by now, or
/// took this robot for failed, and may be anywhere.
void Run::wake(double now) {
  const std::uint32_t epoch = round_.id().epoch;
  round_ = CoordinationRound(process_.name);
  round_.forget(epoch);
  fleet_.wake(now);
  startup_since_ = now;
  reserver_.begin_anew(fleet_, body_.time(), now);
  connectivity_.join(now + listening_time());
}

double Run::listening_time() const {
  return coppice::listening_time(fleet_.longest_braking(), fleet_.second());
}

/// Whether the robot has not known for too long where all peers are.
bool Run::is_too_long(double seconds) const {
  return seconds > std::max(longest_ignorance, least_ignorance * fleet_.second());
}

/// Chooses the velocity of the next period. A robot that is halted, joins or waits for its body takes no
/// notice of the others.
void Run::decide(double now, std::vector<Outgoing>& out) {
  watch_contact(now);
  doubt_orders(now);
  heed_halt(now);
  if (!halted()) watch_joining(now);
  const bool takes_notice = !halted() && !connectivity_.joining() && !its_robot_is_behind(now);
  near_.clear();
  left_out_.clear();
  if (takes_notice) {
    watch_isolation(now);
    if (!body_.bound_to_stand()) look_for_neighbours(now);
    take_up_plans(now, out);
    look_along_the_way(now);
  }
  decision_ = coppice::decide(situation(now));
  carry_out(decision_, now);
  if (takes_notice && !stopped()) watch_arrival(now);
}

void Run::watch_contact(double now) {
  const bool waits = round_.stage() == Stage::waiting;
  fleet_.detect_failures(now, body_.position(), waits ? round_.id() : RoundId{}, map_->field);
  connectivity_.observe(fleet_.cut_off(), now, now + listening_time());
  if (fleet_.out_of_touch()) asks_for_news_until_ = now + asks_for_news * fleet_.second();
}

/// A robot that was out of contact, or a peer that was, may have passed gates that were closed. The robot
/// counts on no order until that is confirmed anew.
void Run::doubt_orders(double now) {
  const std::uint32_t recoveries = fleet_.recoveries();
  const bool somebody_is_back = std::exchange(recoveries_doubted_, recoveries) != recoveries;
  if (!reserver_.holds() || (!connectivity_.listens(now) && !somebody_is_back)) return;
  // By then the others have heard this robot, and say so (docs/safety.md, A10).
  reserver_.held().doubt_all(now + Timing::longest_transit * fleet_.second());
}

/// A joint plan becomes the reservation.
void Run::take_up_plans(double now, std::vector<Outgoing>& out) {
  reserver_.note_who_heard(fleet_, now);
  if (connectivity_.listens(now) || stopped()) return;
  if (round_.stage() == Stage::waiting) round_.wait(self(), fleet_, reserver_, map_->roadmaps, now);
  if (const auto plan = round_.take_up()) {
    reserver_.adopt(*plan, self(), fleet_, now, out);
    take_reserved_path(out);
  }
}

/// How far the way is open, and whether the robot still sees its path: others may have pushed it away.
void Run::look_along_the_way(double now) {
  if (!drives(situation(now))) return;
  const Point2 from = body_.decision_position();
  if (reserver_.holds()) {
    HeldReservation& held = reserver_.held();
    trail_.begin(from);
    held.look_at_gates(fleet_, now, held.open_before(near_, map_->field.inflation(), body_.limits()));
    return;
  }
  Route& route = std::get<Driving>(task_).route;
  if (!route.follower.look_from(from, map_->field, body_.limits())) {
    look_for_a_path(way_back_to_the_path(route));
  } else if (!reserves(mission_.coordination)) {
    trail_.begin(from);
  }
}

Situation Run::situation(double now) {
  const bool holds = reserver_.holds();
  const bool comes_on = holds && !reserver_.held().finished();
  const bool is_to_face = mission_.goal_yaw_tolerance > 0 && driving() && is_at_its_goal() && !comes_on;
  return {.now = now,
          .robot = process_.name,
          .body = body_,
          .task = task_,
          .held = holds ? &reserver_.held() : nullptr,
          .executes_plan = reserver_.executes_plan(),
          .leads_elsewhere = leads_elsewhere(),
          .waits_for_its_turn = reserver_.waits_for_its_turn(),
          .stage = round_.stage(),
          .is_stranded = round_.stranded(),
          .last_moved = last_moved_,
          .faces = is_to_face ? std::optional(mission_.goal_yaw) : std::nullopt,
          .joins = connectivity_.joining(),
          .is_behind = its_robot_is_behind(now),
          .listens = connectivity_.listens(now),
          .may_leave_strip = reserver_.may_leave_strip(self(), fleet_, now),
          .may_set_off = may_set_off(),
          .fleet = fleet_,
          .neighbours = near_,
          .field = map_->field,
          .coordination = mission_.coordination};
}

void Run::carry_out(const Decision& decision, double now) {
  body_.take(next_twist(decision, body_));
  if (const auto* const stands = std::get_if<StandUntil>(&decision.action)) body_.stay(stands->until);
  if (decision.pauses_stall_clock) progress_.pause_stall_clock(now);
  if (decision.comes_on) last_moved_ = now;
  if (decision.cause == Cause::wall) leave_the_wall(now);
  if (decision.cause == Cause::gate || decision.cause == Cause::promise) note_progress(decision, now);
  if (may_stall(decision.cause)) call_if_it_stalls(now);
}

/// A robot that turns on the spot turns to the point for which it heads before it tries a nearer one. The
/// turn excuses it, for as long as a full turn takes.
void Run::note_progress(const Decision& decision, double now) {
  const bool turns = body_.turns_on_the_spot();
  if (turns) progress_.turns(control_period, time_to_turn(2 * std::numbers::pi, body_.limits()), now);
  if (!turns && reserver_.holds()) reserver_.held().led_past(decision.is_led);
  const double progress =
      reserver_.holds() ? reserver_.progress() : std::get<Driving>(task_).route.follower.progress();
  progress_.comes_to(progress, least_gain(body_.radius(), body_.limits()), now);
}

/// The robot plans once it has room.
void Run::leave_the_wall(double now) {
  const double radius = driving_radius(body_.radius(), body_.limits());
  if (body_.stands() && !body_.turns_on_the_spot() && map_->field.is_free(body_.position(), radius))
    set_out(now);
}

/// The process began in mid-run, and waits to hear where all peers are.
void Run::watch_joining(double now) {
  if (!connectivity_.joining()) return;
  // The peer that the robot met last is to tell which peers failed.
  if (!may_set_off()) connectivity_.stand_until(now + listening_time());
  if (!connectivity_.still_joining(now)) {
    if (!has_no_way(phase())) status_.reason.clear();
    return retry_after_change();
  }
  if (!driving()) return;
  status_.reason = "its agent was started or woke in mid-run, and has not heard where all others are";
  // A robot that knows all others only listens: that takes long in a fleet with long brakes.
  if (is_too_long(now - startup_since_) && !may_set_off())
    give_up("its agent was started or woke in mid-run, and nobody who is alive knows where all others are");
}

/// Others hear a peer that this robot does not hear. The robot cannot know where that is, and stands. The two
/// processes may never find each other.
void Run::watch_isolation(double now) {
  const auto unfound = fleet_.heard_by_others_only();
  if (!unfound) {
    if (connectivity_.peers_are_heard()) retry_after_change();
    return;
  }
  const double since = connectivity_.peer_is_unheard(now);
  if (!driving() || !is_too_long(now - since)) return;
  connectivity_.isolate();
  give_up(fmt::format("hears nothing of {}, which others hear: the two do not reach each other", *unfound));
}

/// The robot that follows the body is too far behind.
bool Run::its_robot_is_behind(double now) const {
  return tracking_ && !tracking_->keeps_up(mission_.clock.wall_time(now));
}

Stage Run::stage() const {
  return round_.stage() == Stage::free && reserver_.executes_plan() ? Stage::executing : round_.stage();
}

/// In coordination rounds. A robot that cannot know where all peers are would never be led out of a round.
/// Fleet::member tells the same of a peer.
bool Run::takes_part() const {
  const bool may_not_drive = connectivity_.joining() || connectivity_.isolated();
  return !stopped() && !halted() && !(may_not_drive && has_no_way(phase()));
}

/// A robot sets off when it knows where all others are, and what their clocks say. The missions say how many
/// there are. A robot that lacks some of them does not know where these robots stand.
bool Run::may_set_off() {
  return fleet_.complete();
}

/// All peers that may come near while this robot looks ahead, or brakes.
void Run::look_for_neighbours(double now) {
  const Limits& limits = body_.limits();
  const double horizon = std::max(Driver::horizon, braking_time(limits)) + 3 * control_period;
  const double reach = body_.radius() + horizon * limits.max_speed;
  fleet_.collect_neighbours(body_.position(), reach, horizon, now, process_.state_ages, near_,
                            [&](const RobotState& state, double age) {
                              if (!reserver_.passes(state, age, now)) return false;
                              left_out_.push_back({state.robot, state.reservation});
                              return true;
                            });
}

FleetMember Run::self() const {
  return {.robot = process_.name,
          .position = body_.position(),
          .velocity = body_.velocity(),
          .goal = has_no_way(phase()) ? std::nullopt : std::optional(mission_.goal),
          .arrives_within = arrives_within(mission_),
          .wants_to_stay = phase() == Phase::arrived,
          .radius = body_.radius(),
          .stands = body_.stands(),
          .round = round_.id(),
          .stage = stage(),
          .limits = body_.limits()};
}

}  // namespace coppice
