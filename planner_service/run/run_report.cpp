// The report and the picture of a run: a part of PlannerService.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "coppice/motion/kinematics.h"
#include "coppice/planning/clearance_field.h"
#include "motion/trajectory/segments.h"
#include "planner_service/report/driven.h"
#include "planner_service/run/planner_service.h"
#include "planning/number_text.h"

namespace coppice {

namespace {

constexpr double near_the_goal = 10;  // tolerances

void describe(const AgentLoad& load, proto::Report::Load& to) {
  to.set_samples_received(load.samples_received);
  to.set_states_received(load.states_received);
  to.set_periods(load.periods);
  to.set_periods_missed(load.periods_missed);
  to.set_agents_matched(load.agents_matched);
  to.set_matched_at(load.matched_at);
  to.set_bytes_sent(load.bytes_sent);
  to.set_bytes_received(load.bytes_received);
  to.set_state_age_p50(load.state_age_p50);
  to.set_state_age_p99(load.state_age_p99);
  to.set_state_age_max(load.state_age_max);
  to.set_processor_seconds(load.processor_seconds);
}

void describe(const WaitTimes& waits, proto::Report::Waits& to) {
  to.set_startup(waits.startup);
  to.set_planning(waits.planning);
  to.set_reservation(waits.reservation);
  to.set_joint_plan(waits.joint_plan);
  to.set_gate(waits.gate);
  to.set_promise(waits.promise);
  to.set_connection(waits.connection);
  to.set_odometry(waits.odometry);
}

/// The driven tracks, as fine as a picture shows them.
std::vector<Path> driven_ways(const TrackParts& tracks, std::size_t robots) {
  constexpr double fine = 0.1;  // radii
  std::vector<Path> result(robots);
  tracks([&](const TrackPart& part) {
    for (std::size_t i = 0; i < robots; ++i) {
      const Track& track = part.tracks[i].track;
      for (const TrackPoint& point : track.points) {
        if (result[i].empty() || (point.position - result[i].back()).norm() > fine * track.radius)
          result[i].push_back(point.position);
      }
    }
  });
  return result;
}

/// The times of the first missions.
struct FirstMissions {
  double last_mission = 0;  ///< when the last agent had its mission, fleet seconds
  double last_path = 0;     ///< when the last agent had its first path, fleet seconds
  double improving = 0;     ///< from then until the last robot had the path that it drives, wall seconds
};

FirstMissions first_missions(const RobotRecords& robots, double time_scale) {
  FirstMissions times;
  double last_first_path = 0;  // wall seconds
  double last_best_path = 0;
  for (const RobotRecord& robot : robots) {
    if (!robot.first_status) continue;
    const AgentStatus& first = *robot.first_status;
    times.last_mission = std::max(times.last_mission, first.mission_time);
    times.last_path = std::max(times.last_path, first.path_time);
    const double path_wall = first.path_time / time_scale;
    last_first_path = std::max(last_first_path, path_wall);
    last_best_path = std::max(last_best_path, path_wall + first.improve_seconds);
  }
  times.improving = last_best_path - last_first_path;
  return times;
}

}  // namespace

std::string PlannerService::reason_of(const RobotRecord& robot, bool at_goal, bool comes_to_stand) const {
  if (at_goal) return goals_.shortage_of(robot.index);
  if (clock_of(phase_) == nullptr) return "the run was interrupted before it began";
  if (robot.track_lost())
    return "its agent was started anew without its journal (--state), and does not know where the robot was";
  if (!robot.status)
    return robot.trees_received ? "its agent came, but has not taken up its mission" : "its agent never came";
  if (!robot.status->reason.empty()) return robot.status->reason;
  if (!liveliness_.is_lost(robot.index)) return why_it_is_under_way(robot);
  const auto last = tracks_.last(robot.index);
  if (!last) return "the agent has fallen silent";
  return fmt::format("the agent has fallen silent at {:.1f} s{}", last->time,
                     comes_to_stand ? "" : ", and where its robot came to stand is not known");
}

std::string PlannerService::why_it_is_under_way(const RobotRecord& robot) const {
  if (tracks_.size(robot.index) < robot.status->track_points)
    return "the record of its track is not complete";
  const char* const why = was_interrupted(phase_) ? "the run was interrupted" : "the time was over";
  if (robot.path.empty()) return fmt::format("{} before it had a path", why);
  return fmt::format("{} while it was under way{}", why, rest_of_way(robot));
}

/// ", 12.5 m from its goal". Near its goal also what it lacks to have arrived: it arrives within half of its
/// tolerances.
std::string PlannerService::rest_of_way(const RobotRecord& robot) const {
  const RobotTask& task = robot.task;
  const double left = robot.status->way_left;
  const auto last = tracks_.last(robot.index);
  if (left < 0) return {};
  const double off = last ? (last->position - task.goal).norm() : left;
  if (std::max(left, off) > near_the_goal * task.goal_tolerance)
    return fmt::format(", {} m from its goal", number_text(left, 3));
  const bool turns = last && task.goal_yaw_tolerance > 0;
  const double turned = turns ? std::abs(wrapped(last->yaw - task.goal_yaw)) : 0;
  if (off <= task.goal_tolerance / 2 && turned > task.goal_yaw_tolerance / 2) {
    const auto [yaw, within] = told_apart(turned, task.goal_yaw_tolerance / 2);
    return fmt::format(", at its goal, but {} radians off its yaw: it arrives within {}", yaw, within);
  }
  const auto [distance, within] = told_apart(off, task.goal_tolerance / 2);
  return fmt::format(", {} m from its goal: it arrives once it stays within {} m, half of its goal_tolerance",
                     distance, within);
}

/// Adds what the agent said to a row that holds what the tracks show.
void PlannerService::describe_robot(const RobotRecord& robot, bool comes_to_stand,
                                    proto::Report::Robot& row) const {
  row.set_name(robot.task.name);
  row.set_planned(!robot.path.empty());
  row.set_reason(reason_of(robot, row.arrived(), comes_to_stand));
  for (const Point2& p : robot.path) {
    row.add_path()->set_x(p.x());
    row.mutable_path()->rbegin()->set_y(p.y());
  }
  row.set_path_length(length_of(robot.path));
  row.set_missions(robot.missions_fulfilled(row.arrived()));
  const AgentStatus status = robot.status.value_or(AgentStatus{});
  row.set_plan_time(status.plan_seconds);
  row.set_nodes_valid(robot.earlier_nodes.valid + status.nodes_valid);
  row.set_nodes_invalid(robot.earlier_nodes.invalid + status.nodes_invalid);
  row.set_points_missing(robot.points_missing);
  row.set_grafted_trees(robot.earlier_grafts + status.trees_grafted);
  row.set_free_flow_time(
      free_flow_time(row.path_length(), {robot.task.max_speed, robot.task.max_acceleration}));
  row.set_waited(sum_of(status.waits));
  describe(status.waits, *row.mutable_waits());
  if (robot.periods.all() > 0)
    row.set_periods_missed(static_cast<double>(robot.periods.missed()) / robot.periods.all());
  if (robot.status) describe(status.load, *row.mutable_load());
}

/// Adds the sums over the rows, and what belongs to no robot.
void PlannerService::describe_run(proto::Report& report) const {
  double path_sum = 0;
  int planned = 0;
  bool all_arrived = true;
  for (const proto::Report::Robot& row : report.robots()) {
    all_arrived = all_arrived && row.arrived();
    planned += row.planned();
    path_sum += row.path_length();
    report.set_missions(report.missions() + row.missions());
    report.set_run_time(std::max(report.run_time(), row.run_time()));
    report.set_nodes_valid(report.nodes_valid() + row.nodes_valid());
    report.set_nodes_invalid(report.nodes_invalid() + row.nodes_invalid());
    report.set_trees_grafted(report.trees_grafted() + row.grafted_trees());
  }
  const SeenForest::Nodes nodes = forest_.nodes();
  report.set_nodes_valid(report.nodes_valid() + static_cast<std::uint32_t>(nodes.valid));
  report.set_nodes_invalid(report.nodes_invalid() + static_cast<std::uint32_t>(nodes.invalid));
  report.set_trees_published(static_cast<std::uint32_t>(forest_.trees()));
  const auto without_goal = static_cast<std::uint32_t>(robots_without_goal().size());
  report.set_robots_without_goal(without_goal);
  report.set_outcome(all_arrived && without_goal == 0 ? "arrived"
                     : was_interrupted(phase_)        ? "interrupted"
                     : timed_out(phase_)              ? "timeout"
                                                      : "incomplete");
  const FirstMissions first = first_missions(robots_, settings_.time_scale);
  report.set_plan_time(std::max(0.0, first.last_path - first.last_mission) / settings_.time_scale);
  report.set_improve_time(first.improving);
  if (const FleetClock* const clock = clock_of(phase_)) {
    report.set_last_path_at(clock->wall_time(first.last_path));
  } else if (const auto* const never = std::get_if<NeverBegan>(&phase_)) {
    report.set_last_path_at(never->since);
  }
  report.set_path_length(planned > 0 ? path_sum / planned : 0);
  report.set_seed(scenario_.seed);
  report.set_map(scenario_.map_name);
  report.set_goals_refused(goals_refused_);
  report.set_periods_missed(share_of_periods_missed(robots_));
}

proto::Report PlannerService::report(const TrackParts& tracks, Driven all) const {
  const ClearanceField field(scenario_.map);
  tracks([&](const TrackPart& part) { add(all, part, robots_, field); });
  proto::Report report;
  for (const RobotRecord& robot : robots_) {
    const std::size_t i = robot.index;
    proto::Report::Robot& row = *report.add_robots();
    row.set_arrived(is_at_goal(robot, all.last[i]));
    if (row.arrived() && robot.status)
      row.set_run_time(all.stands_since[i].value_or(robot.status->arrival_time));
    row.set_driven_length(all.length[i]);
    if (is_differential(limits_of(robot.task)) && all.last[i]) row.set_yaw(all.last[i]->yaw);
    describe_robot(robot, !all.last[i] || all.last[i]->velocity.isZero(0), row);
  }
  describe_run(report);
  report.set_margin(scenario_.margin);
  if (all.separation) {
    report.set_least_separation(all.separation->least);
    report.set_least_separation_with_margin(all.separation->least - scenario_.margin);
    report.set_collisions(static_cast<std::uint32_t>(all.separation->overlapping.size()));
  }
  if (all.clearance) {
    report.set_least_clearance(all.clearance->least);
    report.set_least_clearance_with_margin(all.clearance->least - scenario_.margin);
    report.set_collisions(report.collisions() +
                          static_cast<std::uint32_t>(all.clearance->overlapping.size()));
  }
  return report;
}

PictureContent PlannerService::picture() const {
  PictureContent content{.map = scenario_.map, .edges = forest_.edges(), .robots = {}};
  const std::vector<Path> driven = driven_ways(tracks(), robots_.size());
  for (const RobotRecord& robot : robots_) {
    PictureContent::Robot& drawn = content.robots.emplace_back(robot_of(robot.task));
    drawn.path = robot.path;
    drawn.track = driven[robot.index];
    for (const RootNodes::Node& node : robot.root_nodes) {
      if (node.parent < 0 || static_cast<std::size_t>(node.parent) >= robot.root_nodes.size()) continue;
      content.edges.push_back({robot.root_nodes[static_cast<std::size_t>(node.parent)].position,
                               node.position, static_cast<int>(robot.index)});
    }
  }
  return content;
}

}  // namespace coppice
