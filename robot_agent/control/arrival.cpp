// Part of class Run: whether the robot comes on, has arrived, or gives up.
#include <cmath>

#include <fmt/format.h>

#include "robot_agent/control/run.h"
#include "robot_agent/limits.h"

namespace coppice {

namespace {

constexpr double between_retries = Timing::between_retries;

constexpr int most_times_stranded = 5;  // joint plans that may fail a robot before it gives up
constexpr int most_calls_in_vain = 30;  // rounds called from one place before it gives up

}  // namespace

/// Within half of the tolerance, as for the position.
bool Run::heads_as_wanted() const {
  return mission_.goal_yaw_tolerance == 0 ||
         std::abs(wrapped(body_.yaw() - mission_.goal_yaw)) <= mission_.goal_yaw_tolerance / 2;
}

bool Run::is_at_its_goal() const {
  return (body_.position() - mission_.goal).norm() <= arrives_within(mission_);
}

/// A robot has arrived when it stands at its goal with no more moves to make. A robot that others push away
/// from its goal is under way again.
void Run::watch_arrival(double now) {
  const bool comes_on = reserver_.holds() && !reserver_.held().finished();
  const bool may_turn = mission_.goal_yaw_tolerance > 0 && is_at_its_goal() && driving() && !comes_on;
  if (may_turn && body_.turns_on_the_spot()) return progress_.pause_stall_clock(now);
  const bool at_goal = is_at_its_goal() && heads_as_wanted();
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
      return progress_.pause_stall_clock(body_.time());  // the robot that follows the body is on its way
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
    status_.waits.*wait_kind(decision_.cause) += lived;
}

bool Run::is_under_way() const {
  return driving() || std::holds_alternative<Planning>(task_) || std::holds_alternative<DrivingOut>(task_);
}

bool Run::stands_still(double now) const {
  return is_under_way() && now - status_.came_on_at > stall;
}

}  // namespace coppice
