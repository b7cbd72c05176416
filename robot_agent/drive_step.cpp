// Part of class Run: how the robot drives in a control step: by its reservation, along its path by reciprocal
// velocity obstacles, or not at all.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "motion/keep_right.h"
#include "robot_agent/run.h"

namespace coppice {

namespace {

constexpr double close_radii = 1.3;  // sums of radii between two of which one may let the other go first

}  // namespace

/// The robot overlaps an obstacle a little. It plans once it has room.
void Run::drive_out(double now, std::span<const Neighbour> neighbours) {
  auto& out = std::get<DrivingOut>(task_);
  progress_.excuse(now);
  out.is_blocked = !body_.drive_out(out.to, neighbours, map_->field);
  if (!body_.stands() || body_.turns_on_the_spot()) return;
  if (map_->field.is_free(body_.position(), driving_radius(body_.radius(), body_.limits())))
    return set_out(now);
  if (out.is_blocked) stand_for(now, Timing::waiting_lease);
}

/// The robot has no reservation. It stands, and evades where others want to pass.
void Run::evade(Driving& driving, double now, std::span<const Neighbour> neighbours) {
  const Point2 next = body_.turn_position();
  if (!driving.route.follower.look_from(next, map_->field, body_.limits()))
    look_for_a_path(way_back_to_the_path(driving.route));
  body_.choose(Point2::Zero(), neighbours, map_->field);
  if (!reserver_.waits_for_its_turn()) return;
  progress_.excuse(now);
  // Others that set off before it may pass closely, however late its states reach them.
  if (body_.stands()) stand_for(now, 0);
}

/// The robot drives without a reservation, and keeps clear of the others by reciprocal velocity obstacles.
void Run::drive_along_path(Driving& driving, double now, std::span<const Neighbour> neighbours) {
  PathFollower& follower = driving.route.follower;
  const Point2 next = body_.turn_position();
  if (!follower.look_from(next, map_->field, body_.limits())) {
    look_for_a_path(way_back_to_the_path(driving.route));
    return body_.choose(Point2::Zero(), neighbours, map_->field);
  }
  trail_.begin(next);
  progress_.comes_to(follower.progress(), least_gain(body_.radius(), body_.limits()), now);
  const bool is_bound = body_.bound_to_stand();
  const Point2 preferred = follower.preferred_velocity(next, body_.limits(), control_period);
  body_.choose(keeping_right(preferred, next, neighbours), neighbours, map_->field);
  note_movement(now);
  // Several robots may keep clear of each other's next moves: one of them must go.
  const bool is_held_up = now - last_moved_ > Timing::waiting_lease && !body_.turns_on_the_spot();
  if (is_bound || !is_held_up || !lets_others_go_first()) return;
  body_.follow(Point2::Zero(), neighbours, map_->field);
  stand_for(now, Timing::waiting_lease);
}

/// A turn on the spot excuses the robot, for as long as a full turn takes.
void Run::note_movement(double now) {
  if (body_.turns_on_the_spot())
    progress_.turns(control_period, time_to_turn(2 * std::numbers::pi, body_.limits()), now);
  if (body_.promise().next_velocity.norm() > crawl(body_.limits())) last_moved_ = now;
}

/// Of robots that are held up close to each other, those go first that carry out a joint plan, and then the
/// one with the lowest name.
bool Run::lets_others_go_first() const {
  const auto close = fleet_.beside(body_.position(), body_.radius(), close_radii);
  return std::ranges::any_of(close, [&](const FleetMember& m) {
    return !m.failed && !m.wants_to_stay && (m.reservation != 0 || m.robot < process_.name);
  });
}

void Run::keep_to_reservation(double now, std::span<const Neighbour> neighbours) {
  HeldReservation& held = reserver_.held();
  const bool is_bound = body_.bound_to_stand();
  const Point2 next = body_.turn_position();
  trail_.begin(next);
  const double open = held.open_before(neighbours, map_->field.inflation(), body_.limits());
  // Faster, a differential robot would come to the edge of its strip, stop, and turn back on the spot.
  const Point2 wanted =
      body_.slow_to_turn(held.preferred_velocity(self(), fleet_, next, body_.limits(), now, open),
                         reserved_stray_radii * body_.radius());
  const auto allowed = [&](const Twist& m) { return held.allows(body_, m); };
  const bool is_led = body_.follow(wanted, neighbours, map_->field, allowed);
  // A robot that turns on the spot turns to the point for which it heads before it tries a nearer one.
  if (!body_.turns_on_the_spot()) held.led_past(is_led);
  if (!held.waits_for().empty()) {
    if (held.is_worth_waiting(fleet_, now)) progress_.excuse(now);
    // A slow robot must not see the lease run out while it passes.
    const double lease = held.lease(now);
    if (!neighbours.empty() || (is_bound && lease > Timing::longest_lease)) stand_for(now, lease);
    last_moved_ = now;
  }
  note_movement(now);
  // Several robots may keep clear of each other's next moves: one of them must go.
  const bool is_held_up = now - last_moved_ > Timing::waiting_lease;
  if (is_held_up || fleet_.longest_braking() > Timing::longest_lease) give_way(held, wanted, now);
  progress_.comes_to(held.progress(), least_gain(body_.radius(), body_.limits()), now);
}

/// The robot may be held up by others that are held up, too. Who goes is agreed at once, and kept to after
/// `stall`.
void Run::give_way(const HeldReservation& held, const Point2& wanted, double now) {
  const double held_up_for = now - last_moved_;
  const double slowly = std::min(1.0, crawl(body_.limits()) / std::max(wanted.norm(), 1e-9));
  double lease = held.lets_others_pass_for(body_, slowly * wanted, fleet_, held_up_for > stall, now);
  const bool may_agree = held_up_for > Timing::waiting_lease && held_up_for <= stall;
  if (lease == 0 && may_agree && !body_.bound_to_stand() && held.gives_way(self(), fleet_))
    lease = Timing::waiting_lease;
  if (lease == 0) return;
  body_.brake();
  stand_for(now, lease);
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

}  // namespace coppice
