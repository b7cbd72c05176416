#include "simulation/fuzz_judge.h"

#include <algorithm>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "motion/joint/joint_planner.h"
#include "motion/lattice/route_finder.h"
#include "simulation/arrival_bound.h"
#include "simulation/invariants.h"

namespace coppice {

namespace {

/// The robots' tasks from their final positions: failed robots do not move, and robots that arrived are at
/// their goals.
std::vector<JointTask> ends_of(const std::vector<NamedTrack>& tracks, const FleetSimulation& simulation) {
  std::vector<JointTask> ends;
  for (const NamedTrack& track : tracks) {
    const RobotTask& task = simulation.service().task(track.robot);
    const auto& points = track.track.points;
    // No points: killed before it had a body.
    const Point2 end = points.empty() ? task.start : points.back().position;
    const bool killed = simulation.killed(track.robot);
    ends.push_back({end, killed ? std::nullopt : std::optional(task.goal), driving_radius(task), !killed});
  }
  return ends;
}

/// The same as one robot knows them: the failed robots may also stand elsewhere.
std::vector<JointTask> as_known_to(const RobotName& robot, std::vector<JointTask> ends,
                                   const FleetSimulation& simulation) {
  for (const Disc& place : simulation.places_of_failed(robot))
    ends.push_back({place.centre, std::nullopt, place.radius, false});
  return ends;
}

/// Whether a living robot could have arrived from its position, past the failed robots.
bool could_arrive(const ClearanceField& field, const JointTask& robot, std::span<const JointTask> ends) {
  std::vector<Disc> failed;
  for (const JointTask& end : ends) {
    if (!end.movable) failed.push_back({end.position, end.radius});
  }
  // A gap that only a finer lattice finds is too narrow to count.
  RouteFinder finder(field, robot.radius, usual_spacing(robot.radius) / 2);
  return !finder.route(robot.position, *robot.goal, failed).empty();
}

/// Whether a robot could have arrived, with other living robots in its way as well. Failed robots may close
/// the only place where two robots could have exchanged their order.
bool could_be_sorted_out(std::size_t robot, const ClearanceField& field, const std::vector<JointTask>& ends) {
  MapRoadmaps roadmaps(field);
  const JointPlan plan = joint_plan(roadmaps, ends, Random(1));
  return std::ranges::find(plan.stranded, robot) == plan.stranded.end();
}

/// Whether a robot whose agent began in mid-run is right to stand for good (docs/safety.md, A8): of the
/// others, it does not know those that failed where nobody alive knows, and knows all the rest.
bool cannot_know(const proto::Report::Robot& robot, const std::vector<NamedTrack>& tracks,
                 const FleetSimulation& simulation) {
  if (robot.reason().find("its agent was started or woke in mid-run, and") == std::string::npos) return false;
  bool some_are_lost = false;
  for (const NamedTrack& other : tracks) {
    if (other.robot == robot.name() || simulation.knows(robot.name(), other.robot)) continue;
    if (!simulation.lost(other.robot)) return false;
    some_are_lost = true;
  }
  return some_are_lost;
}

}  // namespace

FuzzResult judge(const FuzzCase& fuzz_case, const FleetSimulation& simulation) {
  const std::vector<NamedTrack>& tracks = simulation.tracks();
  FuzzResult result{.failures = broken_invariants(fuzz_case.scenario, simulation),
                    .decisions = simulation.sentinel().decisions(),
                    .suffered = simulation.suffered()};
  if (result.suffered.rejected > 0)
    result.failures.push_back(fmt::format("{} messages that no reader takes", result.suffered.rejected));
  for (const NamedTrack& track : tracks)
    result.robot_hours += static_cast<double>(track.track.points.size()) * control_period / 3600;
  if (simulation.sentinel().broken()) return result;  // the run ended there: nobody is stuck
  const proto::Report report = simulation.service().report(in_parts(tracks));
  const double bound = arrival_bound(fuzz_case, simulation);
  const std::vector<JointTask> ends = ends_of(tracks, simulation);
  const ClearanceField field(fuzz_case.scenario.map, fuzz_case.scenario.margin);
  const bool somebody_died = !std::ranges::all_of(ends, &JointTask::movable);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto& robot = report.robots(static_cast<int>(i));
    if (robot.arrived() && robot.run_time() > bound)
      result.failures.push_back(
          fmt::format("{} arrived after {:.0f} s, and all were to be there after {:.0f} s", robot.name(),
                      robot.run_time(), bound));
    if (robot.arrived() || !ends[i].movable) continue;
    const std::vector<JointTask> known = as_known_to(robot.name(), ends, simulation);
    if (!could_arrive(field, ends[i], known)) continue;
    const bool shut_in = somebody_died && !could_be_sorted_out(i, field, known);
    const bool excused = shut_in || cannot_know(robot, tracks, simulation);
    std::vector<std::string>& list = excused ? result.shut_in : result.failures;
    list.push_back(fmt::format("{} is stuck: {}", robot.name(), robot.reason()));
  }
  return result;
}

}  // namespace coppice
