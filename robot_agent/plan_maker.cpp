#include "robot_agent/plan_maker.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "motion/segments.h"
#include "robot_agent/joint_tasks.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr double roomy = 1.1;  // of the radii

/// Larger robots, if they have room where they stand and at their goals; empty: they have not.
std::vector<JointTask> with_room(std::vector<JointTask> tasks, const ClearanceField& field) {
  for (JointTask& task : tasks) {
    if (task.movable) task.radius *= roomy;
  }
  const auto is_apart = [](const JointTask& a, const Point2& p, const JointTask& b, const Point2& q) {
    return (p - q).norm() >= a.radius + b.radius + standing_gap;
  };
  for (const JointTask& task : tasks) {
    if (!task.movable) continue;
    const std::optional<Point2> end = end_of(task);
    if (!field.is_free(task.position, task.radius) || (end && !field.is_free(*end, task.radius))) return {};
    for (const JointTask& other : tasks) {
      if (&other == &task) continue;
      const std::optional<Point2> others_end = end_of(other);
      const bool fits = is_apart(task, task.position, other, other.position) &&
                        (!end || !others_end || is_apart(task, *end, other, *others_end));
      if (!fits) return {};
    }
  }
  return tasks;
}

}  // namespace

PlanMaker::PlanMaker(MapRoadmaps& places, std::vector<FleetMember> members, std::vector<JointTask> obstacles,
                     std::span<const KnownReservation> others, Random random)
    : places_(places),
      members_(std::move(members)),
      tasks_(joint_tasks(members_, obstacles, places.field())),
      others_(others.begin(), others.end()),
      random_(random) {
  std::vector<JointTask> larger = with_room(tasks_, places.field());
  is_roomy_ = !larger.empty();
  planner_ = std::make_unique<JointPlanner>(places_, is_roomy_ ? std::move(larger) : tasks_, random_);
}

bool PlanMaker::step(double now, bool everybody) {
  if (schedule_) return schedule_->step();
  if (!planner_->step()) return false;
  plan_ = planner_->take_plan();
  planner_.reset();
  if (!plan_.stranded.empty() && std::exchange(is_roomy_, false)) {
    planner_ = std::make_unique<JointPlanner>(places_, tasks_, random_);
    return false;
  }
  if (strands() && everybody) return true;
  schedule(now);
  return false;
}

void PlanMaker::schedule(double now) {
  std::vector<JointSchedule::Robot> robots;
  for (const FleetMember& m : members_) robots.push_back({m.position, m.radius, m.limits});
  std::vector<JointSchedule::Other> others;
  for (const KnownReservation& other : others_) others.push_back({other.trajectory, other.radius});
  std::vector<Disc> obstacles;
  for (const JointTask& task : std::span(tasks_).subspan(members_.size()))
    obstacles.push_back({task.position, task.radius});
  schedule_ =
      std::make_unique<JointSchedule>(places_, std::move(robots), plan_.moves, std::move(others),
                                      std::move(obstacles), now + Timing::plan_to_departure, control_period);
}

JointPlanMessage PlanMaker::message() const {
  JointPlanMessage message{.round = {}, .members = {}, .basis = {}, .run = {}};
  for (std::size_t k = 0; k < members_.size(); ++k) {
    const Trajectory& trajectory = schedule_->trajectories()[k];
    message.members.push_back(
        {members_[k].robot, members_[k].radius, false, trajectory.size() > 1 ? trajectory : Trajectory()});
  }
  for (const std::size_t k : plan_.stranded) message.members[k].stranded = true;
  for (const std::size_t k : schedule_->passed()) message.basis.push_back(others_[k].basis);
  return message;
}

}  // namespace coppice
