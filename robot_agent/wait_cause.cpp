// Part of class Run: the reason why the robot does not come on, as a kind and in words.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "robot_agent/run.h"
#include "robot_agent/words.h"

namespace coppice {

namespace {

constexpr double in_the_way = 2;  // sums of radii between two of which one stops the other

}  // namespace

/// In the order in which a control step looks at what keeps a robot that has a goal to reach.
Run::WaitKind Run::wait_kind(double now) {
  using W = WaitTimes;
  if (is(Phase::planning)) return &W::planning;
  if (connectivity_.joining()) return &W::connection;
  const WallTime wall_now = mission_.clock.wall_time(now);
  if (tracking_ && !(tracking_->is_recent(wall_now) && tracking_->keeps_up(wall_now))) return &W::odometry;
  if (fleet_.cut_off() || connectivity_.listens(now)) return &W::connection;
  if (round_.stage() == Stage::waiting) return &W::joint_plan;
  if (!may_set_off()) return &W::startup;
  if (!reserver_.waits_for().empty()) return &W::gate;
  if (round_.stranded()) return &W::joint_plan;
  return reserver_.holds() || !reserves(mission_.coordination) ? &W::promise : &W::reservation;
}

std::string Run::wait_cause(double now) {
  using W = WaitTimes;
  const WaitKind kind = wait_kind(now);
  if (const auto* out = std::get_if<DrivingOut>(&task_))
    return "it stands too near to an obstacle, and drives out first" +
           (out->is_blocked ? ": " + what_is_in_the_way() : std::string());
  if (kind == &W::planning) return "no path yet: it looks for one";
  if (kind == &W::connection) return what_it_has_not_heard();
  if (kind == &W::odometry) return what_is_wrong_with_the_odometry(mission_.clock.wall_time(now));
  if (kind == &W::joint_plan) return which_plan_it_waits_for();
  if (kind == &W::gate) return fmt::format("it waits for {}, which goes first", reserver_.waits_for());
  if (kind == &W::reservation)
    return reserver_.wants() ? "it waits for its turn to reserve a trajectory"
                             : "no trajectory to its goal is free: it tries again";
  if (kind == &W::startup) return whom_it_does_not_know();
  return what_is_in_the_way();
}

std::string Run::what_it_has_not_heard() const {
  if (connectivity_.joining())
    return "its agent was started or woke in mid-run, and has not heard where all others are";
  return fleet_.cut_off() ? why_it_is_cut_off() : "it was cut off or paused, and listens for what it missed";
}

std::string Run::what_is_wrong_with_the_odometry(WallTime now) const {
  if (!tracking_->is_recent(now)) return "no odometry came";
  return fmt::format("its robot is {:.2f} m off the place where it should be", tracking_->error());
}

std::string Run::which_plan_it_waits_for() const {
  if (round_.stage() == Stage::free)
    return "no joint plan brings it to its goal: it stands until the others are done";
  if (round_.id().leader != process_.name)
    return fmt::format("it stands until {} has made a joint plan", round_.id().leader);
  return round_.plans() ? "it makes a joint plan for the robots around it"
                        : "it is to make a joint plan, and waits until the robots around it stand";
}

std::string Run::whom_it_does_not_know() const {
  const RobotName unknown = fleet_.unknown();
  return unknown.empty() ? fmt::format("{} of {} robots have missions by now",
                                       fleet_.robots_of_the_run().size(), mission_.fleet_size)
                         : fmt::format("it has not heard where {} is", unknown);
}

std::string Run::why_it_is_cut_off() const {
  std::vector<RobotName> unheard = fleet_.missing();
  if (unheard.empty() && fleet_.heard_by_others_only()) unheard.push_back(*fleet_.heard_by_others_only());
  return unheard.empty() ? "cut off: nobody hears it"
                         : fmt::format("cut off: it hears nothing of {}", listed(std::move(unheard)));
}

/// The nearest one: what that may do next leaves no room.
std::string Run::what_is_in_the_way() const {
  const auto close = fleet_.beside(body_.position(), body_.radius(), in_the_way);
  if (close.empty()) {
    std::vector<RobotName> unheard = fleet_.missing();
    return unheard.empty() ? "other robots may come where it wants to go"
                           : fmt::format("it does not know where {} is by now", listed(std::move(unheard)));
  }
  const auto nearest = std::ranges::min_element(
      close, {}, [&](const FleetMember& m) { return (m.position - body_.position()).norm() - m.radius; });
  return nearest->failed ? fmt::format("{} is in the way, and counts as dead", nearest->robot)
                         : fmt::format("{} is in the way", nearest->robot);
}

/// Metres; below 0: the robot has no path. Of a stopped robot: what was left when it was stopped.
double Run::way_left() const {
  if (stopped()) return status_.way_left;
  if (is(Phase::arrived)) return 0;
  const auto* const driving = std::get_if<Driving>(&task_);
  return driving != nullptr ? driving->route.follower.way_left(body_.position()) : -1;
}

}  // namespace coppice
