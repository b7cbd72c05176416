// Part of class PlannerService: what it holds and saves of a run that does not end. It counts tracks for the
// report while they are new, and forgets them. It saves figures instead of all that led to them.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "planner_service/run/planner_service.h"
#include "planner_service/timing.h"

namespace coppice {

namespace {

constexpr std::size_t points_in_a_message = 1000;

TrackMessage::Point point_of(const TrackPoint& point) {
  return {point.time, point.position, point.velocity, point.yaw, point.angular_velocity};
}

void save(const RobotRecord& record, std::size_t points_left, std::size_t points,
          proto::SavedRun::Robot& to) {
  to.set_name(record.task.name);
  to.set_mission(record.mission);
  for (const Point2& place : {record.task.start, record.task.goal}) {
    to.add_task(place.x());
    to.add_task(place.y());
  }
  if (record.task.goal_yaw_tolerance > 0) to.set_goal_yaw(record.task.goal_yaw);
  to.set_replaced_missions(record.replaced_missions);
  to.set_nodes_valid(record.earlier_nodes.valid);
  to.set_nodes_invalid(record.earlier_nodes.invalid);
  to.set_grafts(record.earlier_grafts);
  if (record.first_status) {
    to.set_mission_time(record.first_status->mission_time);
    to.set_path_time(record.first_status->path_time);
    to.set_improve_seconds(record.first_status->improve_seconds);
  }
  to.set_periods(record.periods.all());
  to.set_periods_missed(record.periods.missed());
  to.set_periods_before(record.periods.all_before());
  to.set_periods_missed_before(record.periods.missed_before());
  if (const auto* const began = std::get_if<TrackBegan>(&record.track)) to.set_track_began(began->at);
  to.set_track_lost(record.track_lost());
  to.set_points(points - points_left);
  to.set_next_point(record.next_point - static_cast<std::uint32_t>(points_left));
  to.set_points_missing(record.points_missing);
}

}  // namespace

/// The tracks of all robots are looked at together, so that the least separation is found.
void PlannerService::count_tracks(WallTime now) {
  if (counting_field_ == nullptr) return;
  const double until = clock_of(phase_)->fleet_time(now) - service_timing.tracks_held;
  if (until < counted_until_ + service_timing.counting_interval) return;
  double counted = counted_until_;
  tracks_.for_each_stretch(
      [&](double from, double end) {
        if (end > until) return;
        add(counted_, part_of_tracks(from, end), robots_, *counting_field_);
        counted = end;
      },
      counted_until_);
  counted_until_ = counted;
  tracks_.forget_before(counted_until_);
}

std::vector<TrackMessage> PlannerService::tracks_not_counted(const RobotRecord& robot) const {
  const std::vector<TrackPoint> points =
      tracks_.around(robot.index, counted_until_, std::numeric_limits<double>::infinity());
  std::vector<TrackMessage> all;
  const std::uint32_t first = robot.next_point - static_cast<std::uint32_t>(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k % points_in_a_message == 0)
      all.push_back({robot.task.name, robot.mission, first + static_cast<std::uint32_t>(k), {}, *run()});
    all.back().points.push_back(point_of(points[k]));
  }
  return all;
}

PlannerService::Snapshot PlannerService::snapshot() const {
  Snapshot all;
  proto::SavedRun& figures = all.figures;
  figures.set_counted_until(counted_until_);
  figures.set_goals_refused(goals_refused_);
  std::vector<Message> tracks;
  for (const RobotRecord& robot : robots_) {
    std::size_t points_left = 0;
    for (TrackMessage& track : tracks_not_counted(robot)) {
      points_left += track.points.size();
      tracks.emplace_back(std::move(track));
    }
    save(robot, points_left, tracks_.size(robot.index), *figures.add_robots());
    all.messages.emplace_back(mission_of(robot));
  }
  coppice::save(counted_, figures);
  for (const RobotRecord& robot : robots_) {
    if (robot.status) all.messages.emplace_back(*robot.status);
    if (!robot.path.empty())
      all.messages.emplace_back(PathMessage{robot.task.name, robot.mission, robot.path, *run()});
  }
  std::ranges::move(tracks, std::back_inserter(all.messages));
  for (Message& order : orders_.saved()) all.messages.push_back(std::move(order));
  return all;
}

bool PlannerService::recall(const proto::SavedRun& figures) {
  if (!coppice::recall(figures, counted_)) return false;
  for (RobotRecord& robot : robots_) {
    const proto::SavedRun::Robot& from = figures.robots(static_cast<int>(robot.index));
    if (from.name() != robot.task.name || from.task_size() != 4) return false;
    recall(from, robot);
  }
  counted_until_ = figures.counted_until();
  goals_refused_ = figures.goals_refused();
  return true;
}

void PlannerService::recall(const proto::SavedRun::Robot& from, RobotRecord& robot) {
  robot.go_on_with(
      from.mission(), {from.task(0), from.task(1)},
      {{from.task(2), from.task(3)}, from.has_goal_yaw() ? std::optional(from.goal_yaw()) : std::nullopt});
  robot.replaced_missions = from.replaced_missions();
  robot.earlier_nodes = {from.nodes_valid(), from.nodes_invalid()};
  robot.earlier_grafts = from.grafts();
  if (from.has_mission_time()) {
    robot.first_status = AgentStatus{.robot = robot.task.name,
                                     .mission = 1,
                                     .mission_time = from.mission_time(),
                                     .path_time = from.path_time(),
                                     .improve_seconds = from.improve_seconds()};
  }
  robot.periods = ControlPeriods::counted_before(from.periods(), from.periods_missed(), from.periods_before(),
                                                 from.periods_missed_before());
  if (from.has_track_began()) robot.track = TrackBegan{from.track_began()};
  if (from.track_lost()) robot.track = TrackLost{};
  robot.next_point = from.next_point();
  robot.points_missing = from.points_missing();
  tracks_.count_forgotten(robot.index, from.points());
}

}  // namespace coppice
