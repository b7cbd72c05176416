#include "planner_service/orders/goal_source.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "planner_service/timing.h"

namespace coppice {

GoalSource::GoalSource(const Scenario& scenario)
    : scenario_(scenario), random_(scenario.seed), robots_(scenario.robots.size()) {}

std::optional<std::string> GoalSource::request(std::size_t robot, const NextGoal& goal,
                                               std::span<const RoomOfRobot> robots) {
  const double radius = driving_radius(*robots[robot].task);
  if (!field().is_free(goal.position, radius)) return "it is in an obstacle, or not on the map";
  if (const auto other = in_the_way(robot, goal.position, robots))
    return "it is where another robot goes, " + robots[*other].task->name;
  robots_[robot].request = goal;
  return std::nullopt;
}

std::optional<std::size_t> GoalSource::in_the_way(std::size_t robot, const Point2& goal,
                                                  std::span<const RoomOfRobot> robots) const {
  const double radius = driving_radius(*robots[robot].task);
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const RobotTask& other = *robots[i].task;
    const double apart = radius + driving_radius(other);
    if (i == robot || (robots_[i].request.value_or(NextGoal{other.goal}).position - goal).norm() >= apart)
      continue;
    if (!first || other.name < robots[*first].task->name) first = i;
  }
  return first;
}

std::optional<NextGoal> GoalSource::take_request(std::size_t robot) {
  return std::exchange(robots_[robot].request, std::nullopt);
}

bool GoalSource::may_draw(std::size_t robot, WallTime now) {
  return now >= robots_[robot].next_draw;
}

std::optional<Point2> GoalSource::draw(std::size_t robot, std::span<const RoomOfRobot> robots, WallTime now) {
  auto goal = draw_goal(robot, robots);
  Robot& own = robots_[robot];
  if (goal) return goal;
  own.next_draw = now + service_timing.goal_draw_interval;
  if (!own.shortage.empty()) return std::nullopt;
  const std::size_t places = part_of(*robots[robot].task).size();
  own.shortage =
      places < 2 ? "gets no new goal: it can go nowhere else"
                 : fmt::format("gets no new goal: other robots take all {} places that it can go to", places);
  return std::nullopt;
}

void GoalSource::clear_shortage(std::size_t robot) {
  robots_[robot].shortage.clear();
  robots_[robot].next_draw = 0;
}

const ClearanceField& GoalSource::field() {
  if (!field_) field_.emplace(scenario_.map, scenario_.margin);
  return *field_;
}

/// The part of the map that the robot reaches from its goal, where it stands. Few robots reach different
/// parts, so each part is filled once.
const ReachablePart& GoalSource::part_of(const RobotTask& task) {
  const double radius = driving_radius(task);
  const auto known = std::ranges::find_if(
      parts_, [&](const ReachablePart& part) { return part.radius() == radius && part.contains(task.goal); });
  if (known != parts_.end()) return *known;
  return parts_.emplace_back(ReachablePart::around(field(), radius, task.goal));
}

std::vector<KeepOut> GoalSource::taken_by_others(std::size_t robot, std::span<const RoomOfRobot> robots,
                                                 double spare) const {
  std::vector<KeepOut> taken;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (i == robot) continue;
    const RobotTask& other = *robots[i].task;
    const double apart = driving_radius(other) + driving_radius(*robots[robot].task) + spare;
    taken.push_back({other.goal, apart});
    if (robots[i].stays_at) taken.push_back({*robots[i].stays_at, apart});
  }
  return taken;
}

/// All places are equally likely, as in lifelong multi-agent path finding. The goal leaves a cell between the
/// robot and all others if there is room for that.
std::optional<Point2> GoalSource::draw_goal(std::size_t robot, std::span<const RoomOfRobot> robots) {
  const RobotTask& task = *robots[robot].task;
  const ReachablePart& part = part_of(task);
  if (part.empty()) return std::nullopt;
  const double least_way = 2 * task.radius;
  for (const double spare : {scenario_.map.resolution, 0.0}) {
    auto goal = draw_place(part, task.goal, least_way, taken_by_others(robot, robots, spare), random_);
    if (goal) return goal;
  }
  return std::nullopt;
}

}  // namespace coppice
