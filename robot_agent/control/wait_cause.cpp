// Part of class Run: the cause of the last decision, as a kind of wait and in words.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "robot_agent/control/run.h"
#include "robot_agent/control/words.h"

namespace coppice {

namespace {

constexpr double in_the_way = 2;  // sums of radii between two of which one stops the other

}  // namespace

double WaitTimes::*Run::wait_kind(Cause cause) {
  using W = WaitTimes;
  switch (cause) {
    case Cause::planning:
      return &W::planning;
    case Cause::joining:
    case Cause::listening:
      return &W::connection;
    case Cause::odometry:
      return &W::odometry;
    case Cause::joint_plan:
    case Cause::stranded:
      return &W::joint_plan;
    case Cause::startup:
      return &W::startup;
    case Cause::gate:
      return &W::gate;
    case Cause::strip:
    case Cause::plans_anew:
    case Cause::reservation:
      return &W::reservation;
    case Cause::halted:
    case Cause::idle:
    case Cause::wall:
    case Cause::promise:
      return &W::promise;
  }
  return &W::promise;
}

std::string Run::wait_cause(double now) const {
  switch (decision_.cause) {
    case Cause::planning:
      return "no path yet: it looks for one";
    case Cause::joining:
      return "its agent was started or woke in mid-run, and has not heard where all others are";
    case Cause::listening:
      return fleet_.cut_off() ? why_it_is_cut_off()
                              : "it was cut off or paused, and listens for what it missed";
    case Cause::odometry:
      return what_is_wrong_with_the_odometry(mission_.clock.wall_time(now));
    case Cause::joint_plan:
      return which_plan_it_waits_for();
    case Cause::stranded:
      return "no joint plan brings it to its goal: it stands until the others are done";
    case Cause::startup:
      return whom_it_does_not_know();
    case Cause::gate:
      return fmt::format("it waits for {}, which goes first", reserver_.waits_for());
    case Cause::strip:
      return "others may not have heard yet that it gave up its reservation";
    case Cause::plans_anew:
      return "its reservation leads where it may not go any more: it stops, and reserves another one";
    case Cause::reservation:
      return reserver_.wants() ? "it waits for its turn to reserve a trajectory"
                               : "no trajectory to its goal is free: it tries again";
    case Cause::wall:
      return "it stands too near to an obstacle, and drives out first" +
             (std::holds_alternative<Follow>(decision_.action) ? std::string() : ": " + what_is_in_the_way());
    case Cause::halted:
    case Cause::idle:
    case Cause::promise:
      return what_is_in_the_way();
  }
  return {};
}

std::string Run::what_is_wrong_with_the_odometry(WallTime now) const {
  if (!tracking_->is_recent(now)) return "no odometry came";
  return fmt::format("its robot is {:.2f} m off the place where it should be", tracking_->error());
}

std::string Run::which_plan_it_waits_for() const {
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
