#include <algorithm>
#include <numeric>

#include "bench/centralised.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/plan_paths.h"
#include "motion/lattice/packed_roadmap.h"
#include "motion/lattice/safe_interval_search.h"

namespace coppice {

namespace {

constexpr int attempts = 20;

struct PlannedFleet {
  explicit PlannedFleet(const Scenario& scenario) : robots(scenario.robots), field(scenario.map) {
    std::vector<PlanningProblem> problems;
    for (const RobotTask& robot : robots) problems.push_back({robot.start, robot.goal, robot.radius});
    for (PlannedPath& planned : plan_paths(field, problems, {.seed = scenario.seed}).robots)
      paths.push_back(std::move(planned.path));
  }
  const std::vector<RobotTask>& robots;
  ClearanceField field;
  std::vector<Path> paths{};
};

/// The earliest trajectory of a robot around those of others.
std::optional<Trajectory> trajectory_around(const PlannedFleet& fleet, MapRoadmaps& roadmaps,
                                            std::size_t robot,
                                            const std::vector<std::optional<Trajectory>>& others) {
  const RobotTask& task = fleet.robots[robot];
  SpaceTime taken(fleet.field.bounds(), task.radius);
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (others[k]) taken.add(*others[k], fleet.robots[k].radius);
  }
  SafeIntervalSearch search(fleet.field, roadmaps.lattice(task.radius), task.radius, fleet.paths[robot]);
  return search.search(taken, 0, {task.max_speed, task.max_acceleration});
}

/// The first robot of the order that finds no trajectory; nothing if all found one.
std::optional<std::size_t> plan_in(const std::vector<std::size_t>& order, const PlannedFleet& fleet,
                                   MapRoadmaps& roadmaps, std::vector<std::optional<Trajectory>>& plan) {
  plan.assign(fleet.robots.size(), std::nullopt);
  for (const std::size_t robot : order) {
    plan[robot] = trajectory_around(fleet, roadmaps, robot, plan);
    if (!plan[robot]) return robot;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ReferenceFigures> prioritised_planning(const Scenario& scenario) {
  const PlannedFleet fleet(scenario);
  if (std::ranges::any_of(fleet.paths, &Path::empty)) return std::nullopt;
  MapRoadmaps roadmaps(fleet.field);
  std::vector<std::size_t> order(fleet.robots.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, std::ranges::greater(), [&](std::size_t k) {
    return length_of(fleet.paths[k]) / fleet.robots[k].max_speed;
  });
  std::vector<std::optional<Trajectory>> plan;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const auto failed = plan_in(order, fleet, roadmaps, plan);
    if (failed) {
      const auto at = std::ranges::find(order, *failed);
      std::rotate(order.begin(), at, at + 1);
      continue;
    }
    ReferenceFigures figures{.planner = "prioritised", .sum = 0, .last = 0};
    for (const auto& trajectory : plan) {
      *figures.sum += trajectory->back().time;
      figures.last = std::max(*figures.last, trajectory->back().time);
    }
    return figures;
  }
  return std::nullopt;
}

}  // namespace coppice
