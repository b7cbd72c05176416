// Part of class Run: a control step. The robot brings its body up to the present, listens, drives,
// and tells the others.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "robot_agent/limits.h"
#include "robot_agent/run.h"

namespace coppice {

namespace {

// Timeouts: see timing.h.
constexpr double longest_ignorance = Timing::longest_ignorance;
constexpr double least_ignorance = Timing::least_ignorance;
constexpr double asks_for_news = Timing::asks_for_news;
constexpr double between_retries = Timing::between_retries;
constexpr double longest_stall = Timing::longest_stall;
constexpr double waiting_lease = Timing::waiting_lease;
constexpr double lease_for_delay = Timing::lease_for_delay;
constexpr double longest_delay = Timing::largest_clock_error;

constexpr double decisions_counted = 16;  // of those that may be late: a pause is one
constexpr int most_times_stranded = 5;    // joint plans that may fail a robot before it gives up
constexpr int most_calls_in_vain = 30;    // rounds called from one place before it gives up
constexpr double around_radii = 16;

/// Seconds without progress for which a robot carries out its part of a joint plan. A robot that brakes
/// slowly speeds up slowly, too.
double plan_patience(const Limits& limits) {
  constexpr double of_braking = 0.2;
  return std::max(Timing::plan_patience, of_braking * braking_time(limits));
}

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

/// Chooses the velocity of the next period.
void Run::decide(double now, std::vector<Outgoing>& out) {
  const bool waits = round_.stage() == Stage::waiting;
  fleet_.detect_failures(now, body_.position(), waits ? round_.id() : RoundId{}, map_->field);
  connectivity_.observe(fleet_.cut_off(), now, now + listening_time());
  if (fleet_.out_of_touch()) asks_for_news_until_ = now + asks_for_news * fleet_.second();
  if (is_halted(now) || joins(now) || waits_for_its_robot(now)) return;  // the body brakes
  watch_isolation(now);
  const std::span<const Neighbour> others =
      body_.bound_to_stand() ? std::span<const Neighbour>() : neighbours(now);
  const bool listens = connectivity_.listens(now);
  reserver_.note_who_heard(fleet_, now);
  if (reserver_.holds() && (listens || fleet_.recoveries() != recoveries_)) reserver_.held().doubt_all();
  if (!listens && !stopped()) {
    if (round_.stage() == Stage::waiting) round_.wait(self(), fleet_, reserver_, map_->roadmaps, now);
    if (const auto plan = round_.take_up()) {
      reserver_.adopt(*plan, self(), fleet_, now, out);
      follow_reservation(out);
    }
  }
  const bool free = round_.stage() == Stage::free;
  auto* const driving = std::get_if<Driving>(&task_);
  if (listens) {
    // The body brakes: peers that miss the robot do not reckon with where it would evade to.
    progress_.excuse(now);
    if (body_.stands()) stand_for(now, waiting_lease);
  } else if (!reserver_.may_leave_strip(self(), fleet_, now) ||
             (reserver_.holds() &&
              (reserver_.held().is_overridden() || leads_elsewhere() || !carries_on(now)))) {
    progress_.excuse(now);  // the body brakes, and stays in its strip
    const bool sets_off_soon = !may_set_off();
    if (body_.stands() && !sets_off_soon) stand_for(now, waiting_lease);
  } else if (std::holds_alternative<DrivingOut>(task_) && may_move(now)) {
    drive_out(now, others);
  } else if (reserver_.holds()) {
    keep_to_reservation(now, others);
    call_if_it_stalls(now);
  } else if (may_drive(now)) {
    if (reserves(mission_.coordination)) {
      evade(*driving, now, others);
    } else {
      drive_along_path(*driving, now, others);
    }
    call_if_it_stalls(now);
  } else {
    // A robot that the joint plan cannot help stands out of the others' way until they are done.
    progress_.excuse(now);
    body_.choose(Point2::Zero(), others, map_->field);
    // A robot that plans, or waits for news of the others, may set off at any moment.
    const bool sets_off_soon = std::holds_alternative<Planning>(task_) ||
                               std::holds_alternative<DrivingOut>(task_) ||
                               (driving != nullptr && !may_set_off());
    if (!sets_off_soon) stand_for(now, free ? idle_lease() : waiting_lease);
  }
  if (!stopped()) watch_arrival(now);
}

/// Whether the process, which began in mid-run, still waits to hear where all peers are.
bool Run::joins(double now) {
  if (!connectivity_.joining()) return false;
  // The peer that the robot met last is to tell which peers failed.
  if (!may_set_off()) connectivity_.stand_until(now + listening_time());
  if (!connectivity_.still_joining(now)) {
    if (!has_no_way(phase())) status_.reason.clear();
    retry_after_change();
    return false;
  }
  if (body_.stands()) stand_for(now, waiting_lease);
  if (driving()) {
    status_.reason = "its agent was started or woke in mid-run, and has not heard where all others are";
    // A robot that knows all others only listens: that takes long in a fleet with long brakes.
    if (is_too_long(now - startup_since_) && !may_set_off())
      give_up("its agent was started or woke in mid-run, and nobody who is alive knows where all others are");
  }
  return true;
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

/// The robot that follows the body is too far behind. Nothing is decided, and so the body brakes.
bool Run::waits_for_its_robot(double now) {
  if (!tracking_ || tracking_->keeps_up(mission_.clock.wall_time(now))) return false;
  progress_.excuse(now);
  if (body_.stands()) stand_for(now, waiting_lease);
  return true;
}

/// Nothing holds the robot, but that it may have to wait until it may set off.
bool Run::is_at_large(double now) const {
  return !stopped() && !halted() && round_.stage() == Stage::free && !connectivity_.joining() &&
         !connectivity_.listens(now);
}

bool Run::may_move(double now) {
  return is_at_large(now) && may_set_off();
}

/// The missions say where robots stand that were not heard yet.
bool Run::may_reserve(double now) const {
  return driving() && !round_.stranded() && body_.stands() && is_at_large(now) && fleet_.has_missions() &&
         fleet_.nobody_waits(body_.position(), around());
}

/// The robot drives to its goal on its own, and nothing holds it.
bool Run::may_drive(double now) {
  return driving() && !round_.stranded() && may_move(now);
}

/// The robot drives by its reservation. Others count on its part of a joint plan, whatever its own task is.
bool Run::carries_on(double now) {
  return reserver_.executes_plan() ? may_move(now) : may_drive(now);
}

Stage Run::stage() const {
  return round_.stage() == Stage::free && reserver_.executes_plan() ? Stage::executing : round_.stage();
}

/// Keeps the reservation in step with what the robot is to do. Others rely on a robot with a reservation to
/// stay in its strip. So it gives up a reservation only when it stands.
void Run::reserve(double now, std::vector<Outgoing>& out) {
  auto* const driving = std::get_if<Driving>(&task_);
  const bool serves_nobody = driving == nullptr && !is(Phase::arrived) && !reserver_.executes_plan();
  const bool needs_none = stopped() || halted() || round_.stage() != Stage::free || serves_nobody;
  if (needs_none || (!reserver_.holds() && !reserver_.wants())) {
    if (body_.stands()) reserver_.drop(self(), fleet_, now, out);
  }
  if (needs_none) return;
  if (reserver_.holds()) {
    HeldReservation& held = reserver_.held();
    held.look_at_others(fleet_);
    reserver_.name_those_beside(now, out);
    const bool strayed = held.off_the_way(body_.position()) > body_.radius() / 2;
    const bool over = held.finished() && (body_.position() - mission_.goal).norm() > arrives_within(mission_);
    if (body_.stands() && (strayed || over || leads_elsewhere() || held.is_overridden())) {
      if (over && driving != nullptr && !held.rest().empty()) follow(driving->route, held.rest(), out);
      reserver_.drop(self(), fleet_, now, out);
    }
    return;
  }
  if (!may_reserve(now)) return;
  Route& route = driving->route;
  // The robot's part of a joint plan may have ended elsewhere.
  const Point2 end = route.follower.path().back();
  if ((end - mission_.goal).norm() > arrives_within(mission_)) return look_for_a_path();
  if (!reserves(mission_.coordination)) return;
  if (route.improvement && !route.improvement->is_taut()) {
    if (others_still_search(route, mission_.clock.wall_time(now))) return;
    follow(route, route.improvement->pull_taut(), out);
  }
  if (!reserver_.wants()) {
    if (reserver_.may_try(now)) reserver_.want(way_ahead(), self(), map_->field, now, out);
    return;
  }
  const double ready = may_set_off() ? now : startup_since_ + fleet_.handshakes_take();
  const Path way = way_ahead();
  reserver_.plan(way, ready + time_to_face(way), self(), body_.limits(), fleet_, map_->roadmaps, now, out);
  follow_reservation(out);
}

/// The robot got a new goal on the way. A part of a joint plan may end elsewhere, and is carried out.
bool Run::leads_elsewhere() const {
  if (!reserver_.holds() || reserver_.executes_plan()) return false;
  return (reserver_.held().leads_to() - mission_.goal).norm() > arrives_within(mission_);
}

/// The way of a new reservation, and the rest of the way, are the robot's path.
void Run::follow_reservation(std::vector<Outgoing>& out) {
  auto* const driving = std::get_if<Driving>(&task_);
  if (!reserver_.holds()) return;
  progress_.begin_path();
  if (driving == nullptr) return;
  driving->route.improvement.reset();
  follow(driving->route, reserver_.held().way(), out);
}

/// Calls a coordination round. Not while a joint plan of others is executed around: it may clear the way, and
/// a new round would end it.
void Run::call_if_it_stalls(double now) {
  if (body_.bound_to_stand()) progress_.is_bound(now);
  const bool executes = reserver_.executes_plan();
  if ((!driving() && !executes) || !calls_rounds(mission_.coordination)) return;
  if (fleet_.is_suspected_near(body_.position(), around())) return progress_.excuse(now);
  const double patience = executes            ? plan_patience(body_.limits())
                          : reserver_.holds() ? stall
                                              : Timing::patience_without_trajectory;
  const bool stalls =
      progress_.stalled_for(now) > patience || progress_.without_progress_for(now) > longest_stall;
  if (stalls && (executes || all_free_around() || fleet_.is_awaited(body_.position(), around())))
    round_.call(self(), way_ahead(), fleet_, map_->roadmaps, now);
}

/// Within half of the tolerance, as for the position.
bool Run::heads_as_wanted() const {
  return mission_.goal_yaw_tolerance == 0 ||
         std::abs(wrapped(body_.yaw() - mission_.goal_yaw)) <= mission_.goal_yaw_tolerance / 2;
}

/// Seconds for which a robot with no reason to move binds itself. A robot that brakes for long may only be as
/// fast as it can stop while the others are bound, so these leases grow with its speed.
double Run::idle_lease() const {
  const bool all_brake_soon = fleet_.longest_braking() <= Timing::idle_lease / 2;
  return all_brake_soon ? Timing::idle_lease
                        : std::max(Timing::idle_lease, fleet_.longest_stop() + Timing::idle_lease / 2);
}

void Run::stand_for(double now, double seconds) {
  const double delay = std::min(fleet_.clock_error(now), longest_delay);
  body_.stay(body_.time() + seconds + lease_for_delay * delay);
}

/// A robot has arrived when it stands at its goal with no more moves to make. A robot that others push away
/// from its goal is under way again.
void Run::watch_arrival(double now) {
  const bool is_there = (body_.position() - mission_.goal).norm() <= arrives_within(mission_);
  const bool comes_on = reserver_.holds() && !reserver_.held().finished();
  const bool has_yaw = mission_.goal_yaw_tolerance > 0;
  if (has_yaw && is_there && driving() && body_.stands() && !comes_on) {
    body_.turn_to(mission_.goal_yaw);
    if (body_.turns_on_the_spot()) return progress_.excuse(now);
  }
  const bool at_goal = is_there && heads_as_wanted();
  if (auto* const arrived = std::get_if<Arrived>(&task_); arrived != nullptr && !at_goal) {
    status_.arrival_time = 0;
    enter(Driving{std::move(arrived->route)});
  }
  const auto* const gave_up = std::get_if<GaveUp>(&task_);
  const bool others_go_elsewhere = gave_up != nullptr && fleet_.new_goals() != gave_up->new_goals &&
                                   now - gave_up->at > between_retries * fleet_.second();
  const bool was_led_away = gave_up != nullptr && round_.stage() == Stage::free && body_.stands() &&
                            !comes_on && (gave_up->place - body_.position()).norm() > body_.radius();
  if (fleet_.recoveries() != recoveries_ || others_go_elsewhere || was_led_away) retry_after_change();
  const bool may_improve = fleet_.is_suspected_near(body_.position(), everywhere);
  if (driving() && round_.calls_in_vain() > most_calls_in_vain && !may_improve)
    return give_up(fmt::format("a way past the others was not found within {} joint plans from this place",
                               most_calls_in_vain));
  if (!driving() || round_.stage() != Stage::free || !body_.stands() || comes_on) return;
  if (at_goal) {
    if (tracking_ && !its_robot_is_there(now))
      return progress_.excuse(body_.time());  // the robot that follows the body is on its way
    if (status_.arrival_time == 0) status_.arrival_time = body_.time();
    enter(Arrived{std::move(std::get<Driving>(task_).route)});
  } else if (round_.stranded() && !may_improve && fleet_.all_free(body_.position(), everywhere)) {
    // Where the others are now, another attempt may succeed.
    if (++times_stranded_ < most_times_stranded) return round_.call_everybody(self(), now);
    give_up(fmt::format("a joint plan that brings this robot to its goal was not found within {} attempts",
                        most_times_stranded));
  }
}

/// The robot is driving.
void Run::give_up(std::string reason) {
  if (connectivity_.joining() || connectivity_.isolated()) round_.leave();
  status_.reason = std::move(reason);
  enter(
      GaveUp{std::move(std::get<Driving>(task_).route), body_.position(), body_.time(), fleet_.new_goals()});
}

/// A failed peer is back or is known to stand, others go elsewhere, or a joint plan of others has led the
/// robot elsewhere: what was closed may be open.
void Run::retry_after_change() {
  recoveries_ = fleet_.recoveries();
  times_stranded_ = 0;
  round_.retry_after_change();
  auto* const gave_up = std::get_if<GaveUp>(&task_);
  if (gave_up == nullptr) return;
  status_.reason.clear();
  enter(Driving{std::move(gave_up->route)});
}

/// A robot that is pushed to and fro does not come on, and does not wait.
void Run::watch_movement(double now, double lived) {
  const double gain = least_gain(body_.radius(), body_.limits());
  if (!is_under_way() || (body_.position() - came_to_).norm() >= gain) {
    came_to_ = body_.position();
    status_.came_on_at = now;
  }
  if (is_under_way() && body_.velocity().norm() < waiting_speed_share * body_.limits().max_speed)
    status_.waits.*wait_kind(now) += lived;
}

bool Run::is_under_way() const {
  return driving() || std::holds_alternative<Planning>(task_) || std::holds_alternative<DrivingOut>(task_);
}

bool Run::stands_still(double now) const {
  return is_under_way() && now - status_.came_on_at > stall;
}

/// In coordination rounds. A robot that cannot know where all peers are would never be led out of a round.
/// Fleet::member tells the same of a peer.
bool Run::takes_part() const {
  const bool may_not_drive = connectivity_.joining() || connectivity_.isolated();
  return !stopped() && !halted() && !(may_not_drive && has_no_way(phase()));
}

/// Metres within which the joint plans of others concern the robot.
double Run::around() const {
  return around_radii * body_.radius();
}

bool Run::all_free_around() const {
  return fleet_.all_free(body_.position(), around());
}

/// A robot sets off when it knows where all others are, and what their clocks say. The missions say how many
/// there are. A robot that lacks some of them does not know where these robots stand.
bool Run::may_set_off() {
  return fleet_.complete();
}

/// All peers that may come near while this robot looks ahead, or brakes.
std::span<const Neighbour> Run::neighbours(double now) {
  const Limits& limits = body_.limits();
  const double horizon = std::max(Driver::horizon, braking_time(limits)) + 3 * control_period;
  const double reach = body_.radius() + horizon * limits.max_speed;
  left_out_.clear();
  fleet_.collect_neighbours(body_.position(), reach, horizon, now, process_.state_ages, near_,
                            [&](const RobotState& state, double age) {
                              if (!reserver_.passes(state, age)) return false;
                              left_out_.push_back({state.robot, state.reservation});
                              return true;
                            });
  return near_;
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
