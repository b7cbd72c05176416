#include "planner_service/report/driven.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "motion/trajectory/way_out_of_track.h"

namespace coppice {

Driven::Driven(const std::vector<RobotTask>& tasks)
    : length(tasks.size()), last(tasks.size()), stands_since(tasks.size()) {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (tasks[i].stands_at) drive_out.insert(i);
  }
}

void add(Driven& driven, const TrackPart& part, const RobotRecords& robots, const ClearanceField& field) {
  std::vector<Track> here;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const Track& track = part.tracks[i].track;
    for (const TrackPoint& point : track.points) {
      std::optional<double>& since = driven.stands_since[i];
      if (!is_on_goal(robots[i].task, point))
        since.reset();
      else if (!since && point.velocity.isZero(0))
        since = point.time;
    }
    if (!track.points.empty()) driven.last[i] = track.points.back();
    here.push_back(clipped(track, part.from, part.until));
    const std::vector<TrackPoint>& points = here.back().points;
    for (std::size_t k = 1; k < points.size(); ++k)
      driven.length[i] += (points[k].position - points[k - 1].position).norm();
  }
  add_part(driven.separation, separation_of(here));
  std::optional<ObstacleClearance> clearance = clearance_of(here, field);
  if (clearance && !driven.drive_out.empty()) {
    std::erase_if(driven.drive_out, [&](std::size_t i) { return drop_way_out(here[i], field); });
    clearance->overlapping = clearance_of(here, field).value_or(ObstacleClearance{}).overlapping;
  }
  add_part(driven.clearance, std::move(clearance));
}

void save(const Driven& driven, proto::SavedRun& to) {
  for (const std::size_t robot : driven.drive_out) to.add_drive_out(static_cast<std::uint32_t>(robot));
  for (std::size_t i = 0; i < driven.length.size(); ++i) {
    proto::SavedRun::Robot& robot = *to.mutable_robots(static_cast<int>(i));
    robot.set_driven_length(driven.length[i]);
    if (driven.stands_since[i]) robot.set_stands_since(*driven.stands_since[i]);
    if (!driven.last[i]) continue;
    const TrackPoint& last = *driven.last[i];
    for (const double number : {last.time, last.position.x(), last.position.y(), last.velocity.x(),
                                last.velocity.y(), last.yaw, last.angular_velocity})
      robot.add_last(number);
  }
  if (driven.separation) {
    to.set_least_separation(driven.separation->least);
    for (const auto& [one, other] : driven.separation->overlapping) {
      to.add_touched(static_cast<std::uint32_t>(one));
      to.add_touched(static_cast<std::uint32_t>(other));
    }
  }
  if (driven.clearance) {
    to.set_least_clearance(driven.clearance->least);
    for (const std::size_t robot : driven.clearance->overlapping)
      to.add_touched_obstacles(static_cast<std::uint32_t>(robot));
  }
}

bool recall(const proto::SavedRun& from, Driven& driven) {
  if (static_cast<std::size_t>(from.robots_size()) != driven.length.size() || from.touched_size() % 2 != 0)
    return false;
  driven.drive_out = {from.drive_out().begin(), from.drive_out().end()};
  for (std::size_t i = 0; i < driven.length.size(); ++i) {
    const proto::SavedRun::Robot& robot = from.robots(static_cast<int>(i));
    driven.length[i] = robot.driven_length();
    if (robot.has_stands_since()) driven.stands_since[i] = robot.stands_since();
    if (robot.last_size() == 7)
      driven.last[i] = {robot.last(0),
                        {robot.last(1), robot.last(2)},
                        {robot.last(3), robot.last(4)},
                        robot.last(5),
                        robot.last(6)};
  }
  if (from.has_least_separation()) {
    driven.separation = {from.least_separation(), {}};
    for (int k = 0; k < from.touched_size(); k += 2)
      driven.separation->overlapping.emplace(from.touched(k), from.touched(k + 1));
  }
  if (from.has_least_clearance()) {
    driven.clearance = {from.least_clearance(), {}};
    driven.clearance->overlapping.insert(from.touched_obstacles().begin(), from.touched_obstacles().end());
  }
  return true;
}

}  // namespace coppice
