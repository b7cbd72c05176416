#include <chrono>
#include <iostream>
#include <limits>

#include "bus/process.h"
#include "coppice/commands.h"
#include "files/report_file.h"
#include "planning/fleet_plan.h"

namespace coppice {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

proto::Report report_of(const Scenario& scenario, const FleetPlanner& planner,
                        const std::vector<double>& solved_after) {
  proto::Report report;
  report.set_seed(scenario.seed);
  report.set_map(scenario.map_name);
  report.set_nodes_valid(planner.disjointed_counts().valid);
  report.set_nodes_invalid(planner.disjointed_counts().invalid);
  report.set_trees_published(planner.frozen_trees());
  double sum = 0;
  int planned = 0;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const Path& path = planner.path(i);
    const SampleCounts counts = planner.counts(i);
    auto* row = report.add_robots();
    row->set_name(scenario.robots[i].name);
    row->set_planned(!path.empty());
    row->set_reason(planner.reason(i));
    row->set_plan_time(solved_after[i]);
    row->set_path_length(length_of(path));
    for (const Point2& p : path) {
      auto* place = row->add_path();
      place->set_x(p.x());
      place->set_y(p.y());
    }
    row->set_nodes_valid(counts.valid);
    row->set_nodes_invalid(counts.invalid);
    row->set_grafted_trees(planner.grafted_trees(i));
    report.set_nodes_valid(report.nodes_valid() + counts.valid);
    report.set_nodes_invalid(report.nodes_invalid() + counts.invalid);
    report.set_trees_grafted(report.trees_grafted() + row->grafted_trees());
    sum += row->path_length();
    planned += row->planned();
  }
  report.set_path_length(planned > 0 ? sum / planned : 0);
  report.set_outcome(planned == report.robots_size() ? "planned" : "incomplete");
  return report;
}

PictureContent picture_of(const Scenario& scenario, const FleetPlanner& planner) {
  PictureContent content{.map = scenario.map, .edges = {}, .robots = {}};
  for (const FleetPlanner::Edge& edge : planner.edges())
    content.edges.push_back({edge.from, edge.to, edge.robot});
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const RobotTask& task = scenario.robots[i];
    content.robots.push_back({task.name, task.radius, task.start, task.goal, planner.path(i), {}});
  }
  return content;
}

}  // namespace

int plan_command(const RunOptions& options) {
  const Scenario scenario = read_scenario(options.scenario, options.overrides);
  install_stop_signals();
  const auto begin = Clock::now();
  const ClearanceField field(scenario.map);
  std::vector<PlanningProblem> problems;
  for (const RobotTask& task : scenario.robots) problems.push_back({task.start, task.goal, task.radius});
  FleetPlanner planner(field, problems, {}, Random(scenario.seed));
  std::vector<double> solved_after(problems.size(), 0);
  const auto out_of_time = [&] { return stop_requested() || seconds_since(begin) > options.timeout; };
  for (bool going = true; going && !out_of_time();) {
    going = planner.search();
    for (std::size_t i = 0; i < problems.size(); ++i) {
      if (solved_after[i] == 0 && planner.solved(i)) solved_after[i] = seconds_since(begin);
    }
  }
  planner.take_first_paths();
  const double planned_after = seconds_since(begin);
  const double budget = options.plan_budget.value_or(std::numeric_limits<double>::infinity());
  while ((!planner.all_taut() || seconds_since(begin) < planned_after + budget) && !out_of_time() &&
         planner.improve()) {
  }
  proto::Report report = report_of(scenario, planner, solved_after);
  report.set_plan_time(planned_after);
  report.set_improve_time(seconds_since(begin) - planned_after);
  write_results(options, report, {}, picture_of(scenario, planner));
  if (!options.quiet) std::cout << report_table(report);
  return report.outcome() == "planned" ? 0 : 1;
}

}  // namespace coppice
