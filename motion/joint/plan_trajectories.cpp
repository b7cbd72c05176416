#include "coppice/motion/plan_trajectories.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "coppice/planning/plan_paths.h"
#include "coppice/planning/random.h"
#include "motion/joint/joint_planner.h"
#include "motion/joint/joint_schedule.h"
#include "planning/quantities.h"

namespace coppice {

namespace {

[[noreturn]] void fail(std::size_t task, std::string_view member, const std::string& what) {
  throw std::invalid_argument("tasks[" + std::to_string(task) + "]." + std::string(member) + ": " + what);
}

void check_apart(std::span<const DrivingTask> tasks, Point2 DrivingTask::*place, std::string_view member) {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = (tasks[i].*place - tasks[j].*place).norm();
      if (distance < tasks[i].radius + tasks[j].radius)
        fail(i, member, "overlaps that of tasks[" + std::to_string(j) + "]");
    }
  }
}

void check_tasks(const ClearanceField& field, std::span<const DrivingTask> tasks) {
  std::vector<PlanningProblem> problems;
  for (const DrivingTask& task : tasks) problems.push_back({task.start, task.goal, task.radius});
  if (const auto fault = first_fault(field, problems)) fail(fault->problem, fault->member, fault->what);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const Limits& limits = tasks[i].limits;
    if (!is_sane_size(limits.max_speed) || !is_sane_size(limits.max_acceleration) ||
        !can_brake(limits.max_speed, limits.max_acceleration))
      fail(i, "limits", "expected numbers above 0 with which the robot brakes within 100 s");
  }
  check_apart(tasks, &DrivingTask::start, "start");
  check_apart(tasks, &DrivingTask::goal, "goal");
}

JointPlan joint_plan_for(MapRoadmaps& roadmaps, std::span<const DrivingTask> tasks, std::uint64_t seed) {
  std::vector<JointTask> joint;
  for (const DrivingTask& task : tasks) joint.push_back({task.start, task.goal, task.radius});
  return joint_plan(roadmaps, std::move(joint), Random(seed));
}

}  // namespace

FleetTrajectories plan_trajectories(const ClearanceField& field, std::span<const DrivingTask> tasks,
                                    std::uint64_t seed, const std::function<bool()>& stop) {
  check_tasks(field, tasks);
  if (tasks.empty()) return {};
  MapRoadmaps roadmaps(field);
  JointPlan plan = joint_plan_for(roadmaps, tasks, seed);
  std::vector<JointSchedule::Robot> robots;
  for (const DrivingTask& task : tasks) robots.push_back({task.start, task.radius, task.limits});
  JointSchedule schedule(roadmaps, std::move(robots), std::move(plan.moves), {}, {}, 0, 0);
  while (!schedule.step()) {
    if (schedule.has_times() && stop && stop()) break;
  }
  return {schedule.trajectories(), std::move(plan.stranded)};
}

}  // namespace coppice
