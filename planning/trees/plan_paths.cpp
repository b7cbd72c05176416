#include "coppice/planning/plan_paths.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "coppice/planning/random.h"
#include "planning/geometry/line_of_sight.h"
#include "planning/geometry/voronoi_roadmap.h"
#include "planning/number_text.h"
#include "planning/quantities.h"
#include "planning/trees/fleet_plan.h"
#include "planning/trees/rrt_star.h"
#include "planning/trees/suggestions.h"

namespace coppice {

namespace {

constexpr std::uint64_t samples_between_questions = 256;
// A tree that has not reached the goal by then may never do so. Then all passages are searched.
constexpr std::uint64_t least_iterations = 20'000;
constexpr std::uint64_t cells_a_sample = 8;

/// The time since the plan began, and whether it has to end.
class Deadline {
 public:
  Deadline(const PlanWatch& watch, double timeout) : watch_(watch), timeout_(timeout) {}

  double seconds() const { return now() - begin_; }
  bool is_over() const { return (watch_.stop && watch_.stop()) || seconds() > timeout_; }

 private:
  double now() const { return watch_.clock ? watch_.clock() : 0; }

  const PlanWatch& watch_;
  double timeout_;
  double begin_ = now();
};

/// Runs Algorithm 2 for all problems at once. With a single problem it is Algorithm 1.
PathPlan plan_together(const ClearanceField& field, std::span<const PlanningProblem> problems,
                       const PlanSettings& settings, Random random, const Deadline& deadline) {
  const double begin = deadline.seconds();
  const auto seconds = [&] { return deadline.seconds() - begin; };
  PathPlan plan{.robots = std::vector<PlannedPath>(problems.size())};
  FleetPlanner planner(field, problems, settings.trees, random);
  for (bool going = true; going && !deadline.is_over();) {
    going = planner.search();
    for (std::size_t i = 0; i < problems.size(); ++i) {
      double& solved_after = plan.robots[i].solved_after;
      if (solved_after == 0 && planner.solved(i)) solved_after = seconds();
    }
  }
  planner.take_first_paths();
  plan.plan_time = seconds();
  const auto time_left = [&] { return seconds() < plan.plan_time + settings.improve && !deadline.is_over(); };
  while ((!planner.all_taut() || time_left()) && planner.improve()) {
  }
  plan.improve_time = seconds() - plan.plan_time;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    PlannedPath& robot = plan.robots[i];
    robot.path = planner.path(i);
    robot.reason = planner.reason(i);
    robot.counts = planner.counts(i);
    robot.grafted_trees = planner.grafted_trees(i);
  }
  plan.disjointed = planner.disjointed_counts();
  plan.frozen_trees = planner.frozen_trees();
  plan.edges = planner.edges();
  return plan;
}

/// Runs RRT* for one robot, and straightens its path by line of sight.
PathPlan plan_by_rrt_star(const ClearanceField& field, const PlanningProblem& p, const TreeParameters& trees,
                          Random random, const Deadline& deadline) {
  const double begin = deadline.seconds();
  RrtStar<ClearanceField> planner(field, p.start, p.goal, p.radius, completed(trees, field, p.radius).epsilon,
                                  random);
  const std::uint64_t most_samples =
      std::max<std::uint64_t>(least_iterations, field.frame().cells() / cells_a_sample);
  std::uint64_t samples = 1;
  while (samples < most_samples && planner.step() &&
         (samples % samples_between_questions != 0 || !deadline.is_over()))
    ++samples;
  Path path = planner.path();
  if (path.empty() && samples >= most_samples)
    path = VoronoiRoadmap(field).way(p.start, p.goal, p.radius).value_or(Path());
  PathPlan plan;
  PlannedPath& robot = plan.robots.emplace_back();
  robot.path = optimise_line_of_sight(field, path, p.radius);
  if (robot.path.empty()) {
    robot.reason = samples >= most_samples
                       ? "no path: the goal cannot be reached from the start with this radius"
                       : "no path found before the time was over";
  }
  robot.counts = {planner.valid(), planner.invalid()};
  robot.solved_after = plan.plan_time = deadline.seconds() - begin;
  return plan;
}

/// Plans for each robot alone, one after the other.
PathPlan plan_apart(const ClearanceField& field, std::span<const PlanningProblem> problems,
                    const PlanSettings& settings, const Deadline& deadline) {
  PathPlan all;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const Random random(settings.seed * 1'000'003 + i);
    PathPlan one = settings.planner == PlannerKind::rrt_star
                       ? plan_by_rrt_star(field, problems[i], settings.trees, random, deadline)
                       : plan_together(field, problems.subspan(i, 1), settings, random, deadline);
    one.robots[0].solved_after += all.plan_time + all.improve_time;
    all.robots.push_back(std::move(one.robots[0]));
    all.disjointed.valid += one.disjointed.valid;
    all.disjointed.invalid += one.disjointed.invalid;
    all.frozen_trees += one.frozen_trees;
    for (TreeEdge edge : one.edges) {
      if (edge.robot >= 0) edge.robot = static_cast<int>(i);
      all.edges.push_back(edge);
    }
    all.plan_time += one.plan_time;
    all.improve_time += one.improve_time;
  }
  return all;
}

/// Nothing if the disc is free there.
std::optional<std::string> place_fault(const ClearanceField& field, const Point2& p, double radius) {
  if (field.is_free(p, radius)) return std::nullopt;
  const Box<2> box = field.bounds();
  const auto place = [](const Point2& q) {
    return "(" + number_text(q.x()) + ", " + number_text(q.y()) + ")";
  };
  const bool is_inside = (p.array() >= box.lower.array()).all() && (p.array() <= box.upper.array()).all();
  if (!is_inside)
    return place(p) + " is outside of the map, which covers " + place(box.lower) + " to " + place(box.upper);
  const auto [clearance, needed] = told_apart(field.clearance(p), radius);
  return place(p) + " is inside of an obstacle or too near to one: clearance " + clearance + ", radius " +
         needed;
}

}  // namespace

std::optional<ProblemFault> first_fault(const ClearanceField& field,
                                        std::span<const PlanningProblem> problems) {
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const PlanningProblem& p = problems[i];
    if (!is_sane_size(p.radius)) {
      return ProblemFault{i, "radius",
                          number_text(p.radius) + " is not allowed, expected a number above 0, from " +
                              number_text(least_quantity) + " to " + number_text(largest_quantity)};
    }
    if (auto fault = place_fault(field, p.start, p.radius)) return ProblemFault{i, "start", *fault};
    if (auto fault = place_fault(field, p.goal, p.radius)) return ProblemFault{i, "goal", *fault};
  }
  return std::nullopt;
}

PathPlan plan_paths(const ClearanceField& field, std::span<const PlanningProblem> problems,
                    const PlanSettings& settings, const PlanWatch& watch) {
  if (const auto fault = first_fault(field, problems)) {
    throw std::invalid_argument("problems[" + std::to_string(fault->problem) + "]." +
                                std::string(fault->member) + ": " + fault->what);
  }
  if (const auto fault = fault_of(settings.trees))
    throw std::invalid_argument("settings.trees." + std::string(*fault));
  const Deadline deadline(watch, settings.timeout);
  return settings.planner == PlannerKind::ma_rrdt_star
             ? plan_together(field, problems, settings, Random(settings.seed), deadline)
             : plan_apart(field, problems, settings, deadline);
}

}  // namespace coppice
