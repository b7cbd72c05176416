#include "robot_agent/joint_tasks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "motion/segments.h"

namespace coppice {

namespace {

constexpr int goal_rings = 9;  // about a goal that is disputed
constexpr int points_on_ring = 24;

/// Whether another of the tasks is to end too close to p for the one of a robot.
bool is_taken(const Point2& p, std::span<const JointTask> tasks, const JointTask& own) {
  return std::ranges::any_of(tasks, [&](const JointTask& o) {
    const std::optional<Point2> end = o.movable ? o.goal : o.position;
    return &o != &own && end && (*end - p).norm() < own.radius + o.radius + standing_gap;
  });
}

/// The nearest point found to a robot's goal at which it has arrived as well, and is in nobody's way.
std::optional<Point2> place_at_goal(const FleetMember& m, std::span<const JointTask> tasks,
                                    const JointTask& own, const ClearanceField& field) {
  for (int ring = 0; ring <= goal_rings; ++ring) {
    for (int k = 0; k < (ring == 0 ? 1 : points_on_ring); ++k) {
      const double angle = 2 * std::numbers::pi * k / points_on_ring;
      const double distance = m.arrives_within * ring / (goal_rings + 1);
      const Point2 p = *m.goal + distance * Point2(std::cos(angle), std::sin(angle));
      if (field.is_free(p, own.radius) && !is_taken(p, tasks, own)) return p;
    }
  }
  return std::nullopt;
}

/// What the members are to do: to drive to their goals, or beside them where two would stand too close to
/// each other.
struct Aims {
  std::vector<JointTask> tasks;  ///< of the members, then of the obstacles
  bool undisputed = false;       ///< there is room for all
};
Aims aims_of(std::span<const FleetMember> members, std::span<const JointTask> obstacles,
             const ClearanceField& field, bool arrived_stay) {
  Aims aims;
  for (const FleetMember& m : members) {
    const bool has_goal = m.goal && is_on_map(field, *m.goal);
    const Point2 end = arrived_stay && m.arrived ? m.position : m.goal.value_or(m.position);
    aims.tasks.push_back({m.position, has_goal ? std::optional(end) : std::nullopt, m.radius});
  }
  aims.tasks.insert(aims.tasks.end(), obstacles.begin(), obstacles.end());
  for (std::size_t i = 0; i < members.size(); ++i) {
    JointTask& task = aims.tasks[i];
    const bool stays = arrived_stay && members[i].arrived;
    if (!task.goal || stays || !is_taken(*task.goal, aims.tasks, task)) continue;
    task.goal = place_at_goal(members[i], aims.tasks, task, field).value_or(*task.goal);
  }
  aims.undisputed = std::ranges::none_of(
      std::span(aims.tasks).first(members.size()),
      [&](const JointTask& task) { return task.goal && is_taken(*task.goal, aims.tasks, task); });
  return aims;
}

}  // namespace

bool is_on_map(const ClearanceField& field, const Point2& p, double radius) {
  const Box<2> box = field.bounds();
  return (p.array() >= box.lower.array() - radius).all() && (p.array() <= box.upper.array() + radius).all();
}

std::vector<JointTask> joint_tasks(std::span<const FleetMember> members, std::span<const JointTask> obstacles,
                                   const ClearanceField& field) {
  Aims aims = aims_of(members, obstacles, field, true);
  if (aims.undisputed) return std::move(aims.tasks);
  Aims wider = aims_of(members, obstacles, field, false);
  return std::move(wider.undisputed ? wider.tasks : aims.tasks);
}

}  // namespace coppice
