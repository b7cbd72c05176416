#include "planner_service/report/robot_record.h"

#include <cmath>
#include <utility>

#include "coppice/motion/kinematics.h"
#include "files/robot_starts.h"

namespace coppice {

namespace {

constexpr double same_beginning = 0.01;             // fleet seconds: the same first point, sent again
constexpr std::size_t most_root_nodes = 1'000'000;  // of a robot, for the picture

}  // namespace

bool is_on_goal(const RobotTask& task, const TrackPoint& point) {
  return (point.position - task.goal).norm() <= task.goal_tolerance &&
         (task.goal_yaw_tolerance == 0 ||
          std::abs(wrapped(point.yaw - task.goal_yaw)) <= task.goal_yaw_tolerance);
}

Point2 rest_of(const TrackPoint& last, const RobotTask& robot) {
  return last.position + last.velocity * last.velocity.norm() / (2 * robot.max_acceleration);
}

void ControlPeriods::count(const AgentLoad& load, bool first_status) {
  if (first_status && all_ == 0) {
    all_before_ = load.periods;
    missed_before_ = load.periods_missed;
  }
  const bool restarted = load.periods < all_before_ + all_ || load.periods_missed < missed_before_ + missed_;
  if (restarted) {
    all_before_ = load.periods - all_;
    missed_before_ = load.periods_missed - missed_;
  }
  all_ = load.periods - all_before_;
  missed_ = load.periods_missed - missed_before_;
}

void RobotRecord::update(const AgentStatus& latest, bool run_has_ended) {
  periods.count(latest.load, !status);
  // An agent that was restarted tells less of its first path.
  const bool tells_less =
      first_status && first_status->path_time > 0 && latest.path_time != first_status->path_time;
  if (latest.mission == 1 && !tells_less) first_status = latest;
  std::string reason_before = status ? status->reason : "";
  status = latest;
  // At the end all missions are cancelled. An agent that had given up then sees its way free for a moment,
  // and withdraws its reason. The report needs that reason.
  if (run_has_ended && status->reason.empty()) status->reason = std::move(reason_before);
}

/// A robot that was pushed off its path returns to its goal on another path. The report shows the path from
/// the start.
void RobotRecord::update(const PathMessage& latest) {
  const bool from_the_start = path.empty() || latest.waypoints.empty() || latest.waypoints[0] == path[0];
  if (from_the_start) path = latest.waypoints;
}

void RobotRecord::add(const RootNodes& batch) {
  if (batch.first_index == root_nodes.size() && root_nodes.size() < most_root_nodes)
    root_nodes.insert(root_nodes.end(), batch.nodes.begin(), batch.nodes.end());
}

/// An agent that was restarted with its saved state sends the same track again. One without begins another.
bool RobotRecord::track_begins(double at) {
  if (std::holds_alternative<NoTrack>(track)) track = TrackBegan{at};
  const auto* const began = std::get_if<TrackBegan>(&track);
  if (began == nullptr || std::abs(at - began->at) < same_beginning) return false;
  track = TrackLost{};
  return true;
}

void RobotRecord::begin_next_mission(const Point2& start, const NextGoal& goal) {
  replaced_missions += !arrived();
  const AgentStatus done = status.value_or(AgentStatus{});
  earlier_nodes.valid += done.nodes_valid;
  earlier_nodes.invalid += done.nodes_invalid;
  earlier_grafts += done.trees_grafted;
  go_on_with(mission + 1, start, goal);
}

void RobotRecord::go_on_with(std::uint32_t number, const Point2& start, const NextGoal& goal) {
  mission = number;
  task.start = start;
  task.stands_at.reset();
  task.goal = goal.position;
  task.goal_yaw = goal.yaw.value_or(0);
  const bool turns = goal.yaw && is_differential(limits_of(task));
  task.goal_yaw_tolerance = turns ? default_yaw_tolerance : 0;
  status.reset();
  path.clear();
  root_nodes.clear();
}

void RobotRecord::begins_at(const Point2& place, double yaw, const ClearanceField& field) {
  task.goal = task.start;
  task.goal_yaw = task.goal_yaw_tolerance = 0;
  stands_at(place, yaw, field);
}

void RobotRecord::stands_at(const Point2& place, double yaw, const ClearanceField& field) {
  begin_at(task, place, field);
  task.start_yaw = yaw;
}

void RobotRecord::began_as(const Mission& saved, const ClearanceField& field) {
  // A robot that follows was told a start that has room.
  task.start = saved.start;
  task.start_yaw = saved.start_yaw;
  task.stands_at.reset();
  if (mission > 1) return;
  if (task.tracking_tolerance == 0) begin_at(task, saved.start, field);
  task.goal = saved.goal;
  task.goal_yaw = saved.goal_yaw;
  task.goal_yaw_tolerance = saved.goal_yaw_tolerance;
}

RobotRecords::RobotRecords(const std::vector<RobotTask>& tasks) {
  for (const RobotTask& task : tasks) {
    index_.emplace(task.name, records_.size());
    records_.push_back({.task = task, .index = records_.size()});
  }
}

RobotRecord* RobotRecords::find(const RobotName& name) {
  const auto known = index_.find(name);
  return known == index_.end() ? nullptr : &records_[known->second];
}

double share_of_periods_missed(const RobotRecords& robots) {
  double periods = 0;
  double missed = 0;
  for (const RobotRecord& robot : robots) {
    periods += robot.periods.all();
    missed += robot.periods.missed();
  }
  return periods > 0 ? missed / periods : 0;
}

}  // namespace coppice
