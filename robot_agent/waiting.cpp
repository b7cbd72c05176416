// Of RobotAgent: why it does not come on, in words.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "robot_agent/robot_agent.h"
#include "robot_agent/words.h"

namespace coppice {

namespace {

constexpr WallTime all_missions_come = 3;  // seconds in which those of a run come one after the other
constexpr double in_the_way = 2;           // sums of radii between two of which one stops the other

}  // namespace

/// In the order in which a control step looks at what keeps it. Empty: it comes on, or has nowhere to go.
std::string RobotAgent::wait_cause(double fleet_now) {
  if (!does_not_come_on(fleet_now)) return {};
  if (status_.phase == Phase::planning) return "no path yet: it looks for one";
  if (is_new_) return "its agent was started in mid-run, and has not heard where all others are";
  const WallTime now = mission_->clock.wall_time(fleet_now);
  if (tracking_ && !tracking_->is_recent(now)) return "no odometry came";
  if (tracking_ && !tracking_->keeps_up(now))
    return fmt::format("its robot is {:.2f} m off the place where it should be", tracking_->error());
  if (fleet_.cut_off()) return why_it_is_cut_off();
  if (fleet_now < heard_again_at_) return "it was cut off or paused, and listens for what it missed";
  if (round_.stage() == Stage::waiting && round_.id().leader == name_)
    return round_.plans() ? "it makes a joint plan for the robots around it"
                         : "it is to make a joint plan, and waits until the robots around it stand";
  if (round_.stage() == Stage::waiting)
    return fmt::format("it stands until {} has made a joint plan", round_.id().leader);
  if (round_.stage() == Stage::executing && !round_.waits_for().empty())
    return fmt::format("it waits for {}, which goes first by the joint plan", round_.waits_for());
  if (round_.stage() == Stage::free && !may_set_off(fleet_now)) {
    const RobotName unknown = fleet_.unknown();
    return unknown.empty() ? fmt::format("{} of {} robots have missions by now",
                                         fleet_.robots_of_the_run().size(), mission_->fleet_size)
                           : fmt::format("it has not heard where {} is", unknown);
  }
  if (round_.stage() == Stage::free && round_.stranded())
    return "no joint plan brings it to its goal: it stands until the others are done";
  if (round_.stage() == Stage::free && lets_others_finish_) return "it lets others finish their joint plan";
  return what_is_in_the_way();
}

std::string RobotAgent::why_it_is_cut_off() const {
  std::vector<RobotName> unheard = fleet_.missing();
  if (unheard.empty() && fleet_.heard_by_others_only()) unheard.push_back(*fleet_.heard_by_others_only());
  return unheard.empty() ? "cut off: nobody hears it"
                         : fmt::format("cut off: it hears nothing of {}", listed(std::move(unheard)));
}

/// The nearest one: what that may do next leaves no room.
std::string RobotAgent::what_is_in_the_way() const {
  const auto close = fleet_.beside(body_->position(), body_->radius(), in_the_way);
  if (close.empty()) return "other robots may come where it wants to go";
  const auto nearest = std::ranges::min_element(
      close, {}, [&](const FleetMember& m) { return (m.position - body_->position()).norm() - m.radius; });
  return nearest->failed ? fmt::format("{} is in the way, and counts as dead", nearest->robot)
                       : fmt::format("{} is in the way", nearest->robot);
}

/// Empty: none has come yet, and none needs to have.
std::string RobotAgent::why_it_has_no_mission(WallTime now) const {
  const auto& own = fleet_.own_mission();
  if (own && !own->cancelled && now - *run_heard_at_ > all_missions_come)
    return "the map of its mission has not come";
  if (own || !run_heard_at_) return {};
  std::vector<RobotName> robots = fleet_.robots_of_the_run();
  const bool all_have_come = robots.size() >= fleet_.size_of_the_run();
  if (robots.empty() || (!all_have_come && now - *run_heard_at_ <= all_missions_come)) return {};
  std::ranges::sort(robots, counts_before);
  return robots.size() == 1 ? fmt::format("no mission for {}: the run has {}", name_, robots.front())
                            : fmt::format("no mission for {}: the run has {} robots, {} to {}", name_,
                                          robots.size(), robots.front(), robots.back());
}

/// Metres; below 0: it has none. That of one that was stopped is what it had left then.
double RobotAgent::way_left() const {
  if (status_.phase == Phase::stopped) return status_.way_left;
  if (status_.phase == Phase::arrived) return 0;
  return follower_ && status_.phase == Phase::driving ? follower_->remaining(body_->position()) : -1;
}

}  // namespace coppice
