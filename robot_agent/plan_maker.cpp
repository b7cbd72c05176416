#include "robot_agent/plan_maker.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "motion/segments.h"
#include "planning/free_way.h"
#include "robot_agent/joint_tasks.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr double roomy = 1.1;    // of the radii
constexpr int roomy_steps = 10;  // of the planner: LaCAM has then found a plan, or evacuation is next

/// A position close to p at which a larger robot has room; none: there is none.
std::optional<Point2> with_room_near(const Point2& p, double radius, double larger,
                                     const ClearanceField& field) {
  constexpr int directions = 32;
  const double aside = 1.2 * (larger - radius);
  for (int k = -1; k < directions; ++k) {
    const double angle = 2 * std::numbers::pi * k / directions;
    const Point2 there = k < 0 ? p : Point2(p + aside * Point2(std::cos(angle), std::sin(angle)));
    if (field.is_free(there, larger) && way_free(field, p, there, radius)) return there;
  }
  return std::nullopt;
}

/// The tasks of larger robots, if these have room at the goals, and close to where the robots stand; empty:
/// they have not. Where two robots stand closely, the edges of the roadmap allow for it.
std::vector<JointTask> with_room(std::span<const JointTask> tasks, const ClearanceField& field) {
  std::vector<JointTask> larger(tasks.begin(), tasks.end());
  for (JointTask& task : larger) {
    if (!task.movable) continue;
    const auto start = with_room_near(task.position, task.radius, roomy * task.radius, field);
    if (!start || (task.goal && !field.is_free(*task.goal, roomy * task.radius))) return {};
    if (task.goal != task.position) task.position = *start;
    task.radius *= roomy;
  }
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!tasks[i].movable) continue;
    for (std::size_t j = 0; j < tasks.size(); ++j) {
      if (j == i) continue;
      const auto end = end_of(larger[i]);
      const auto others_end = end_of(larger[j]);
      const double near = larger[i].radius + larger[j].radius + standing_gap;
      if (end && others_end && (*end - *others_end).norm() < near) return {};
      const double touching = tasks[i].radius + tasks[j].radius + standing_gap;
      const bool stays = larger[i].position == tasks[i].position && larger[j].position == tasks[j].position;
      if (!stays && (larger[i].position - larger[j].position).norm() < touching) return {};
    }
  }
  return larger;
}

}  // namespace

PlanMaker::PlanMaker(MapRoadmaps& places, std::vector<FleetMember> members, std::vector<JointTask> obstacles,
                     std::span<const KnownReservation> others, Random random)
    : places_(places),
      members_(std::move(members)),
      tasks_(joint_tasks(members_, obstacles, places.field())),
      others_(others.begin(), others.end()),
      random_(random),
      roomy_steps_left_(roomy_steps) {
  std::vector<JointTask> larger = with_room(tasks_, places.field());
  is_roomy_ = !larger.empty();
  planner_ = std::make_unique<JointPlanner>(places_, is_roomy_ ? std::move(larger) : tasks_, random_);
}

bool PlanMaker::step(double now, bool everybody) {
  if (schedule_) return schedule_->step();
  const bool ends = planner_->step();
  const bool tries_in_vain =
      is_roomy_ && (ends ? !planner_->plan().stranded.empty() : --roomy_steps_left_ == 0);
  if (tries_in_vain) {
    is_roomy_ = false;
    planner_ = std::make_unique<JointPlanner>(places_, tasks_, random_);
    return false;
  }
  if (!ends) return false;
  plan_ = planner_->take_plan();
  planner_.reset();
  if (strands() && everybody) return true;
  begin_where_robots_stand();
  schedule(now);
  return false;
}

/// The moves of larger robots may begin a little beside.
void PlanMaker::begin_where_robots_stand() {
  std::vector<bool> has_set_off(members_.size());
  for (Move& move : plan_.moves) {
    const Point2& start = members_[move.robot].position;
    if (!has_set_off[move.robot] && move.path.front() != start) move.path.insert(move.path.begin(), start);
    has_set_off[move.robot] = true;
  }
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
