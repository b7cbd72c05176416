// Part of class Run: the robot gets its reservation, gives it up, and calls a coordination round where it
// stalls.
#include <algorithm>
#include <cmath>

#include "robot_agent/control/run.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

constexpr double longest_stall = Timing::longest_stall;
constexpr double around_radii = 16;

/// Seconds without progress for which a robot carries out its part of a joint plan. A robot that brakes
/// slowly speeds up slowly, too.
double plan_patience(const Limits& limits) {
  constexpr double of_braking = 0.2;
  return std::max(Timing::plan_patience, of_braking * braking_time(limits));
}

}  // namespace

/// The missions say where robots stand that were not heard yet.
bool Run::may_reserve(double now) const {
  const bool is_held = connectivity_.joining() || connectivity_.listens(now);
  return driving() && !round_.stranded() && body_.stands() && round_.stage() == Stage::free && !is_held &&
         fleet_.has_missions() && fleet_.nobody_waits(body_.position(), around());
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
  take_reserved_path(out);
}

/// The robot got a new goal on the way. A part of a joint plan may end elsewhere, and is carried out.
bool Run::leads_elsewhere() const {
  if (!reserver_.holds() || reserver_.executes_plan()) return false;
  return (reserver_.held().leads_to() - mission_.goal).norm() > arrives_within(mission_);
}

/// The way of a new reservation, and the rest of the way, are the robot's path.
void Run::take_reserved_path(std::vector<Outgoing>& out) {
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
  if (fleet_.is_suspected_near(body_.position(), around())) return progress_.pause_stall_clock(now);
  const double patience = executes            ? plan_patience(body_.limits())
                          : reserver_.holds() ? stall
                                              : Timing::patience_without_trajectory;
  const bool stalls =
      progress_.stalled_for(now) > patience || progress_.without_progress_for(now) > longest_stall;
  if (stalls && (executes || all_free_around() || fleet_.is_awaited(body_.position(), around())))
    round_.call(self(), way_ahead(), fleet_, map_->roadmaps, now);
}

/// From the robot to its goal, as far as it knows.
Path Run::way_ahead() const {
  const auto* const driving = std::get_if<Driving>(&task_);
  Path way = driving != nullptr ? driving->route.follower.rest() : Path();
  way.insert(way.begin(), body_.position());
  return way;
}

/// Seconds in which a differential robot turns on the spot until it heads along a way.
double Run::time_to_face(const Path& way) const {
  const auto next = std::ranges::find_if(way, [&](const Point2& p) { return p != way.front(); });
  if (next == way.end()) return 0;
  const Point2 ahead = *next - way.front();
  return time_to_turn(wrapped(std::atan2(ahead.y(), ahead.x()) - body_.yaw()), body_.limits());
}

/// Metres within which the joint plans of others concern the robot.
double Run::around() const {
  return around_radii * body_.radius();
}

bool Run::all_free_around() const {
  return fleet_.all_free(body_.position(), around());
}

}  // namespace coppice
