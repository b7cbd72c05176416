#include <algorithm>
#include <chrono>
#include <functional>
#include <iostream>
#include <limits>
#include <span>

#include "coppice/commands.h"
#include "files/report_file.h"
#include "planning/fleet_plan.h"
#include "planning/line_of_sight.h"
#include "planning/rrt_star.h"
#include "planning/suggestions.h"
#include "planning/voronoi_roadmap.h"
#include "runtime/process.h"

namespace coppice {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t samples_between_questions = 256;
// A tree that has not reached the goal by then may never do so. Then all passages are searched.
constexpr std::uint64_t least_iterations = 20'000;
constexpr std::uint64_t cells_a_sample = 8;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The results of planning, for any planner.
struct Plans {
  struct Robot {
    Path path;
    std::string reason;  ///< why there is no path
    double solved_after = 0;
    SampleCounts counts;
    std::uint32_t grafted_trees = 0;
  };
  std::vector<Robot> robots;
  SampleCounts disjointed;
  std::uint32_t frozen_trees = 0;
  std::vector<FleetPlanner::Edge> edges;
  double plan_time = 0;
  double improve_time = 0;
};

/// Runs Algorithm 2 for all problems at once. With a single problem it is Algorithm 1.
Plans plan_together(const ClearanceField& field, std::span<const PlanningProblem> problems, Random random,
                    double budget, const std::function<bool()>& out_of_time) {
  const auto begin = Clock::now();
  Plans plans;
  plans.robots.resize(problems.size());
  FleetPlanner planner(field, problems, random);
  for (bool going = true; going && !out_of_time();) {
    going = planner.search();
    for (std::size_t i = 0; i < problems.size(); ++i) {
      double& solved_after = plans.robots[i].solved_after;
      if (solved_after == 0 && planner.solved(i)) solved_after = seconds_since(begin);
    }
  }
  planner.take_first_paths();
  plans.plan_time = seconds_since(begin);
  const auto time_left = [&] { return seconds_since(begin) < plans.plan_time + budget && !out_of_time(); };
  while ((!planner.all_taut() || time_left()) && planner.improve()) {
  }
  plans.improve_time = seconds_since(begin) - plans.plan_time;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    Plans::Robot& robot = plans.robots[i];
    robot.path = planner.path(i);
    robot.reason = planner.reason(i);
    robot.counts = planner.counts(i);
    robot.grafted_trees = planner.grafted_trees(i);
  }
  plans.disjointed = planner.disjointed_counts();
  plans.frozen_trees = planner.frozen_trees();
  plans.edges = planner.edges();
  return plans;
}

/// Runs RRT* for one robot, and straightens its path by line of sight.
Plans plan_by_rrt_star(const ClearanceField& field, const PlanningProblem& p, Random random,
                       const std::function<bool()>& out_of_time) {
  const auto begin = Clock::now();
  RrtStar<ClearanceField> planner(field, p.start, p.goal, p.radius, suggested_epsilon(field, p.radius),
                                  random);
  const std::uint64_t most_samples =
      std::max<std::uint64_t>(least_iterations, field.frame().cells() / cells_a_sample);
  std::uint64_t samples = 1;
  while (samples < most_samples && planner.step() &&
         (samples % samples_between_questions != 0 || !out_of_time()))
    ++samples;
  Path path = planner.path();
  if (path.empty() && samples >= most_samples)
    path = VoronoiRoadmap(field).way(p.start, p.goal, p.radius).value_or(Path());
  Plans plans;
  Plans::Robot& robot = plans.robots.emplace_back();
  robot.path = optimise_line_of_sight(field, path, p.radius);
  if (robot.path.empty()) {
    robot.reason = samples >= most_samples
                       ? "no path: the goal cannot be reached from the start with this radius"
                       : "no path found before the time was over";
  }
  robot.counts = {planner.valid(), planner.invalid()};
  robot.solved_after = plans.plan_time = seconds_since(begin);
  return plans;
}

/// Plans for each robot alone, one after the other.
Plans plan_apart(const ClearanceField& field, std::span<const PlanningProblem> problems, PlannerKind kind,
                 std::uint64_t seed, double budget, const std::function<bool()>& out_of_time) {
  Plans all;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const Random random(seed * 1'000'003 + i);
    Plans one = kind == PlannerKind::rrt_star
                    ? plan_by_rrt_star(field, problems[i], random, out_of_time)
                    : plan_together(field, problems.subspan(i, 1), random, budget, out_of_time);
    one.robots[0].solved_after += all.plan_time + all.improve_time;
    all.robots.push_back(std::move(one.robots[0]));
    all.disjointed.valid += one.disjointed.valid;
    all.disjointed.invalid += one.disjointed.invalid;
    all.frozen_trees += one.frozen_trees;
    for (FleetPlanner::Edge edge : one.edges) {
      if (edge.robot >= 0) edge.robot = static_cast<int>(i);
      all.edges.push_back(edge);
    }
    all.plan_time += one.plan_time;
    all.improve_time += one.improve_time;
  }
  return all;
}

proto::Report report_of(const Scenario& scenario, const Plans& plans) {
  proto::Report report;
  report.set_seed(scenario.seed);
  report.set_map(scenario.map_name);
  report.set_plan_time(plans.plan_time);
  report.set_improve_time(plans.improve_time);
  report.set_nodes_valid(plans.disjointed.valid);
  report.set_nodes_invalid(plans.disjointed.invalid);
  report.set_trees_published(plans.frozen_trees);
  double sum = 0;
  int planned = 0;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const Plans::Robot& robot = plans.robots[i];
    auto* row = report.add_robots();
    row->set_name(scenario.robots[i].name);
    row->set_planned(!robot.path.empty());
    row->set_reason(robot.reason);
    row->set_plan_time(robot.solved_after);
    row->set_path_length(length_of(robot.path));
    for (const Point2& p : robot.path) {
      auto* place = row->add_path();
      place->set_x(p.x());
      place->set_y(p.y());
    }
    row->set_nodes_valid(robot.counts.valid);
    row->set_nodes_invalid(robot.counts.invalid);
    row->set_grafted_trees(robot.grafted_trees);
    report.set_nodes_valid(report.nodes_valid() + robot.counts.valid);
    report.set_nodes_invalid(report.nodes_invalid() + robot.counts.invalid);
    report.set_trees_grafted(report.trees_grafted() + robot.grafted_trees);
    sum += row->path_length();
    planned += row->planned();
  }
  report.set_path_length(planned > 0 ? sum / planned : 0);
  report.set_outcome(planned == report.robots_size() ? "planned" : "incomplete");
  return report;
}

PictureContent picture_of(const Scenario& scenario, const Plans& plans) {
  PictureContent content{.map = scenario.map, .edges = {}, .robots = {}};
  for (const FleetPlanner::Edge& edge : plans.edges)
    content.edges.push_back({edge.from, edge.to, edge.robot});
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const RobotTask& task = scenario.robots[i];
    content.robots.push_back({task.name, task.radius, task.start, task.goal, plans.robots[i].path, {}});
  }
  return content;
}

}  // namespace

int plan_command(const RunOptions& options) {
  const Scenario scenario = read_scenario(options.scenario, options.overrides);
  check_results(options, scenario);
  install_stop_signals();
  const auto begin = Clock::now();
  const ClearanceField field(scenario.map);
  std::vector<PlanningProblem> problems;
  for (const RobotTask& task : scenario.robots) problems.push_back({task.start, task.goal, task.radius});
  const double budget = options.plan_budget.value_or(std::numeric_limits<double>::infinity());
  const auto out_of_time = [&] { return stop_requested() || seconds_since(begin) > options.timeout; };
  const PlannerKind kind = chosen_planner(options);
  const Plans plans = kind == PlannerKind::ma_rrdt_star
                          ? plan_together(field, problems, Random(scenario.seed), budget, out_of_time)
                          : plan_apart(field, problems, kind, scenario.seed, budget, out_of_time);
  const proto::Report report = report_of(scenario, plans);
  const auto nobody_drives = [](const auto&) {};
  write_results(options, report, nobody_drives, [&] { return picture_of(scenario, plans); });
  if (!options.quiet) std::cout << report_table(report);
  return report.outcome() == "planned" ? 0 : 1;
}

}  // namespace coppice
