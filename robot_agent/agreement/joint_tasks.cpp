#include "robot_agent/agreement/joint_tasks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

constexpr double share_of_tolerance = 0.9;  // of `arrives_within`
// Goals that are a little too close to each other are pushed apart, all together, up to so many times.
constexpr int pushes = 100;
constexpr double gap_radii = 0.004;  // mean radii: robots stop a little off their ends
constexpr double beyond = 1.05;      // of the gap, so that they are soon apart
// For goals that remain disputed, points on rings about the goal are tried.
constexpr int goal_rings = 9;
constexpr int points_on_ring = 24;

/// Metres between the edges of two robots at their ends.
double gap_between(const JointTask& a, const Point2& end_a, const JointTask& b, const Point2& end_b) {
  return (end_a - end_b).norm() - a.radius - b.radius;
}

/// Whether another robot is to end too close to p for the robot of the task `own`.
bool is_taken(const Point2& p, std::span<const JointTask> tasks, const JointTask& own) {
  return std::ranges::any_of(tasks, [&](const JointTask& o) {
    const std::optional<Point2> end = end_of(o);
    return &o != &own && end && gap_between(own, p, o, *end) < standing_gap;
  });
}

/// Moves the end of a task to p, or as close to p as the robot has arrived there.
void move_end(JointTask& task, const FleetMember& m, const Point2& p, const ClearanceField& field) {
  const Point2 off = p - *m.goal;
  const double most = share_of_tolerance * m.arrives_within;
  const Point2 end = off.norm() > most ? *m.goal + most / off.norm() * off : p;
  if (field.is_free(end, task.radius)) task.goal = end;
}

/// The nearest point to a robot's goal, of those on the rings, at which the robot has arrived as well, and is
/// in nobody's way.
std::optional<Point2> place_at_goal(const FleetMember& m, std::span<const JointTask> tasks,
                                    const JointTask& own, const ClearanceField& field) {
  for (int ring = 0; ring <= goal_rings; ++ring) {
    for (int k = 0; k < (ring == 0 ? 1 : points_on_ring); ++k) {
      const double angle = 2 * std::numbers::pi * k / points_on_ring;
      const double distance = share_of_tolerance * m.arrives_within * ring / goal_rings;
      const Point2 p = *m.goal + distance * Point2(std::cos(angle), std::sin(angle));
      if (field.is_free(p, own.radius) && !is_taken(p, tasks, own)) return p;
    }
  }
  return std::nullopt;
}

/// Pushes ends apart that are a little too close to each other, pair by pair, until none are. Only ends that
/// yield() are moved.
template <class Yields>
void push_apart(std::span<const FleetMember> members, std::vector<JointTask>& tasks, Yields&& yields,
                const ClearanceField& field) {
  bool pushed = true;
  for (int round = 0; round < pushes && pushed; ++round) {
    pushed = false;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        if (!yields(i) && !yields(k)) continue;
        const std::optional<Point2> a = end_of(tasks[i]);
        const std::optional<Point2> b = end_of(tasks[k]);
        if (!a || !b || *a == *b) continue;
        const double gap = gap_between(tasks[i], *a, tasks[k], *b);
        const double wanted = std::max(standing_gap, gap_radii * (tasks[i].radius + tasks[k].radius) / 2);
        if (gap >= wanted) continue;
        const Point2 away = (*a - *b).normalized();
        const Point2 step = (beyond * wanted - gap) / (yields(i) && yields(k) ? 2 : 1) * away;
        if (yields(i)) move_end(tasks[i], members[i], *tasks[i].goal + step, field);
        if (yields(k)) move_end(tasks[k], members[k], *tasks[k].goal - step, field);
        pushed = true;
      }
    }
  }
}

/// The members are to drive to their goals, or beside them where two would stand too close to each other.
struct Aims {
  std::vector<JointTask> tasks;  ///< of the members, then of the obstacles
  bool undisputed = false;       ///< there is room for all
};
Aims aims_of(std::span<const FleetMember> members, std::span<const JointTask> obstacles,
             const ClearanceField& field, bool arrived_stay) {
  Aims aims;
  for (const FleetMember& m : members) {
    const bool has_goal = m.goal && is_on_map(field, *m.goal);
    const Point2 end = arrived_stay && m.wants_to_stay ? m.position : m.goal.value_or(m.position);
    aims.tasks.push_back({m.position, has_goal ? std::optional(end) : std::nullopt, m.radius});
  }
  aims.tasks.insert(aims.tasks.end(), obstacles.begin(), obstacles.end());
  const auto yields = [&](std::size_t i) {
    return i < members.size() && aims.tasks[i].goal && !(arrived_stay && members[i].wants_to_stay);
  };
  push_apart(members, aims.tasks, yields, field);
  for (std::size_t i = 0; i < members.size(); ++i) {
    JointTask& task = aims.tasks[i];
    if (yields(i) && is_taken(*task.goal, aims.tasks, task))
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

std::vector<JointTask> joint_tasks_at_goals(std::span<const FleetMember> members,
                                            std::span<const JointTask> obstacles,
                                            const ClearanceField& field) {
  return aims_of(members, obstacles, field, false).tasks;
}

}  // namespace coppice
