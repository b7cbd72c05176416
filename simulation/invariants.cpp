#include "simulation/invariants.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "messages/clock_offset.h"
#include "motion/trajectory/way_out_of_track.h"

namespace coppice {

namespace {

constexpr double rounding_of_tracks = 1e-6;
// A robot keeps its limits and its periods by its agent's clock, which may be too fast or too slow.
constexpr double by_own_clock = 1 + clock_drift;

/// The same of how a differential robot turns.
std::optional<std::string> broken_by_turning(const RobotTask& task, const TrackPoint& before,
                                             const TrackPoint& p, double period) {
  if (std::abs(p.angular_velocity) > task.max_angular_speed * by_own_clock + rounding_of_tracks)
    return fmt::format("turned with {:.3f} rad/s at {:.2f} s", p.angular_velocity, p.time);
  if (std::abs(p.angular_velocity - before.angular_velocity) >
      task.max_angular_acceleration * period * by_own_clock + rounding_of_tracks)
    return fmt::format("changed its turning too fast at {:.2f} s", p.time);
  if (std::abs(wrapped(before.yaw + (p.time - before.time) * before.angular_velocity - p.yaw)) >
      rounding_of_tracks)
    return fmt::format("jumped to another yaw at {:.2f} s", p.time);
  const double chord = p.yaw + period * p.angular_velocity / 2;
  const double ahead = p.velocity.dot(Point2(std::cos(chord), std::sin(chord)));
  if (std::abs(ahead - p.velocity.norm()) > rounding_of_tracks)
    return fmt::format("drove sideways or backward at {:.2f} s", p.time);
  return std::nullopt;
}

/// The first invariant that a robot has broken by itself.
std::optional<std::string> broken_by(const RobotTask& task, const Track& track, double period) {
  const auto& points = track.points;
  if (points.empty()) return std::nullopt;
  if ((points.front().position - task.stands_at.value_or(task.start)).norm() > rounding_of_tracks)
    return "did not begin at its start";
  for (std::size_t k = 0; k < points.size(); ++k) {
    const TrackPoint& p = points[k];
    if (p.velocity.norm() > task.max_speed * by_own_clock + rounding_of_tracks)
      return fmt::format("drove {:.3f} m/s at {:.2f} s", p.velocity.norm(), p.time);
    if (k == 0) continue;
    const TrackPoint& before = points[k - 1];
    const double between = p.time - before.time;
    if (std::abs(between - period) > clock_drift * period + rounding_of_tracks)
      return fmt::format("has a gap in its record before {:.2f} s", p.time);
    if ((before.position + between * before.velocity - p.position).norm() > rounding_of_tracks)
      return fmt::format("jumped at {:.2f} s", p.time);
    if ((p.velocity - before.velocity).norm() >
        task.max_acceleration * period * by_own_clock + rounding_of_tracks)
      return fmt::format("changed its speed too fast at {:.2f} s", p.time);
    if (task.max_angular_speed > 0) {
      if (const auto problem = broken_by_turning(task, before, p, period)) return problem;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> broken_invariants(const Scenario& scenario, const std::vector<NamedTrack>& tracks,
                                           double period) {
  std::vector<std::string> broken;
  for (const NamedTrack& named : tracks) {
    const auto task = std::ranges::find(scenario.robots, named.robot, &RobotTask::name);
    if (const auto problem = broken_by(*task, named.track, period))
      broken.push_back(named.robot + " " + *problem);
  }
  const ClearanceField field(scenario.map);
  std::optional<Separation> separation;
  std::optional<ObstacleClearance> clearance;
  std::vector<std::string> drive_out;
  for (const RobotTask& task : scenario.robots) {
    if (task.stands_at) drive_out.push_back(task.name);
  }
  in_parts(tracks)([&](const TrackPart& part) {
    std::vector<Track> here;
    for (const NamedTrack& named : part.tracks) here.push_back(clipped(named.track, part.from, part.until));
    add_part(separation, separation_of(here));
    std::erase_if(drive_out, [&](const std::string& robot) {
      const auto named = std::ranges::find(part.tracks, robot, &NamedTrack::robot);
      return named != part.tracks.end() &&
             drop_way_out(here[static_cast<std::size_t>(named - part.tracks.begin())], field);
    });
    add_part(clearance, clearance_of(here, field));
  });
  if (separation && separation->least < -overlap_tolerance)
    broken.push_back(fmt::format("robots touched: least separation {:.6f} m, {} pairs", separation->least,
                                 separation->overlapping.size()));
  if (clearance && clearance->least < -overlap_tolerance)
    broken.push_back(fmt::format("obstacles were touched: least clearance {:.6f} m, {} robots",
                                 clearance->least, clearance->overlapping.size()));
  return broken;
}

std::vector<std::string> broken_invariants(const Scenario& scenario, const FleetSimulation& simulation) {
  std::vector<std::string> broken = broken_invariants(scenario, simulation.tracks(), control_period);
  if (const auto& lemma = simulation.sentinel().broken()) broken.insert(broken.begin(), *lemma);
  return broken;
}

}  // namespace coppice
