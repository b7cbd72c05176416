#include "robot_agent/agreement/plan_maker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "motion/trajectory/segments.h"
#include "planning/geometry/free_way.h"
#include "robot_agent/agreement/joint_tasks.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr int most_in_vain = 3;  // plans in a row that are no better
// Another plan is made if a robot waits on average so many times as long as it takes to make it.
constexpr double waits_that_are_worth_a_plan = 100;

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

/// The tasks of robots that are larger by a share of their radius and some metres, if these have room at the
/// goals, and close to where the robots stand; empty: they have not. Where two robots stand closely, the
/// edges of the roadmap allow for it.
std::vector<JointTask> with_room(std::span<const JointTask> tasks, const ClearanceField& field, double share,
                                 double metres) {
  std::vector<JointTask> larger(tasks.begin(), tasks.end());
  for (JointTask& task : larger) {
    if (!task.movable) continue;
    const double radius = (1 + share) * task.radius + metres;
    const auto start = with_room_near(task.position, task.radius, radius, field);
    if (!start || (task.goal && !field.is_free(*task.goal, radius))) return {};
    if (task.goal != task.position) task.position = *start;
    task.radius = radius;
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

PlanMaker::PlanMaker(MapRoadmaps& roadmaps, std::vector<FleetMember> members,
                     std::vector<JointTask> obstacles, std::span<const KnownReservation> others,
                     Random random, double now)
    : roadmaps_(roadmaps),
      members_(std::move(members)),
      others_(others.begin(), others.end()),
      random_(random),
      attempts_(attempts(members_, obstacles, roadmaps.field())),
      phase_(first_attempt(random_, now)) {
  for (const JointTask& task : obstacles) obstacles_.push_back({task.position, task.radius});
}

/// First robots with room to pass each other at full speed, then those that keep their margins.
std::vector<PlanMaker::Attempt> PlanMaker::attempts(std::span<const FleetMember> members,
                                                    std::span<const JointTask> obstacles,
                                                    const ClearanceField& field) {
  constexpr int few_steps = 10;  // LaCAM has then found a plan, or evacuation is next
  constexpr int any_number = std::numeric_limits<int>::max();
  const std::vector<JointTask> tasks = joint_tasks(members, obstacles, field);
  std::vector<Attempt> all{{with_room(tasks, field, comfort_radii, 0), few_steps}};
  if (field.inflation() > 0) all.push_back({with_room(tasks, field, 0, field.inflation() / 2), few_steps});
  std::erase_if(all, [](const Attempt& attempt) { return attempt.tasks.empty(); });
  all.push_back({tasks, any_number});
  if (std::ranges::any_of(members, &FleetMember::wants_to_stay))
    all.push_back({joint_tasks_at_goals(members, obstacles, field), any_number});
  return all;
}

bool PlanMaker::step(double now, bool everybody) {
  if (auto* const moves = std::get_if<MakesMoves>(&phase_)) return make_moves(*moves, now, everybody);
  if (auto* const times = std::get_if<FindsTimes>(&phase_)) {
    if (times->schedule->has_times()) {
      compare(*times, now);
    } else {
      times->schedule->step();
    }
    return false;
  }
  return std::holds_alternative<Fails>(phase_) || std::get<ImprovesTimes>(phase_).schedule->step();
}

bool PlanMaker::strands() const {
  const auto* const complete = std::get_if<ImprovesTimes>(&phase_);
  return complete == nullptr || !complete->plan.stranded.empty();
}

PlanMaker::MakesMoves PlanMaker::first_attempt(Random random, double since) const {
  const auto& [tasks, most_steps] = attempts_.front();
  return {std::make_unique<JointPlanner>(roadmaps_, tasks, random), since, most_steps};
}

/// Returns true if there is no plan that brings everybody to the goal.
bool PlanMaker::make_moves(MakesMoves& phase, double now, bool everybody) {
  std::optional<JointPlan> plan = phase.planner->step();
  const bool is_last_resort = attempts_.size() == 1 && !best_;
  const bool fails = !is_last_resort && (plan ? !plan->stranded.empty() : --phase.steps_left == 0);
  if (fails && best_) {
    go_on(now);
  } else if (fails) {
    attempts_.erase(attempts_.begin());
    phase = first_attempt(random_, phase.since);
  } else if (plan) {
    if (everybody && !plan->stranded.empty()) {
      phase_ = Fails();
      return true;
    }
    begin_where_robots_stand(*plan);
    auto schedule = schedule_of(*plan, now);
    phase_ = FindsTimes{*std::move(plan), std::move(schedule), phase.since};
  }
  return false;
}

void PlanMaker::compare(FindsTimes& phase, double now) {
  const bool is_worthwhile = waiting(phase) >= waits_that_are_worth_a_plan * (now - phase.since);
  const bool goes_on = phase.plan.stranded.empty() && is_worthwhile;
  const double sum = phase.schedule->sum_of_arrivals();
  if (!best_ || sum < best_->sum) {
    best_ = Best{std::move(phase.plan), sum};
    in_vain_ = -1;
  }
  if (!goes_on) in_vain_ = most_in_vain;
  go_on(now);
}

/// Seconds that a robot waits in the plan, on average.
double PlanMaker::waiting(const FindsTimes& phase) const {
  double sum = 0;
  for (const Trajectory& trajectory : phase.schedule->trajectories())
    sum += trajectory.back().time - trajectory.front().time;
  for (const Move& move : phase.plan.moves)
    sum -= length_of(move.path) / members_[move.robot].limits.max_speed;
  return sum / static_cast<double>(members_.size());
}

/// Makes another plan, or chooses the best one.
void PlanMaker::go_on(double now) {
  if (++in_vain_ < most_in_vain) {
    phase_ = first_attempt(Random(random_.next()), now);
  } else {
    auto schedule = schedule_of(best_->plan, now);
    phase_ = ImprovesTimes{std::move(best_->plan), std::move(schedule)};
  }
}

/// The moves of larger robots may begin a little beside.
void PlanMaker::begin_where_robots_stand(JointPlan& plan) const {
  std::vector<bool> has_set_off(members_.size());
  for (Move& move : plan.moves) {
    const Point2& start = members_[move.robot].position;
    if (!has_set_off[move.robot] && move.path.front() != start) move.path.insert(move.path.begin(), start);
    has_set_off[move.robot] = true;
  }
}

std::unique_ptr<JointSchedule> PlanMaker::schedule_of(const JointPlan& plan, double now) const {
  std::vector<JointSchedule::Robot> robots;
  for (const FleetMember& m : members_) robots.push_back({m.position, m.radius, m.limits});
  std::vector<JointSchedule::Other> others;
  for (const KnownReservation& other : others_) others.push_back({other.trajectory, other.radius});
  return std::make_unique<JointSchedule>(roadmaps_, std::move(robots), plan.moves, std::move(others),
                                         obstacles_, now + Timing::plan_to_departure, control_period);
}

JointPlanMessage PlanMaker::message() const {
  const auto& [plan, schedule] = std::get<ImprovesTimes>(phase_);
  JointPlanMessage message{.round = {}, .members = {}, .basis = {}, .run = {}};
  for (std::size_t k = 0; k < members_.size(); ++k) {
    const Trajectory& trajectory = schedule->trajectories()[k];
    message.members.push_back(
        {members_[k].robot, members_[k].radius, false, trajectory.size() > 1 ? trajectory : Trajectory()});
  }
  for (const std::size_t k : plan.stranded) message.members[k].stranded = true;
  for (const std::size_t k : schedule->passed()) message.basis.push_back(others_[k].basis);
  return message;
}

}  // namespace coppice
