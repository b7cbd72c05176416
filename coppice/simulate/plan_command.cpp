#include <algorithm>
#include <chrono>
#include <iostream>
#include <limits>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "coppice/commands.h"
#include "coppice/planning/plan_paths.h"
#include "files/report_file.h"
#include "runtime/process.h"

namespace coppice {

namespace {

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

proto::Report report_of(const Scenario& scenario, const PathPlan& plan) {
  proto::Report report;
  report.set_seed(scenario.seed);
  report.set_map(scenario.map_name);
  report.set_plan_time(plan.plan_time);
  report.set_improve_time(plan.improve_time);
  report.set_nodes_valid(plan.disjointed.valid);
  report.set_nodes_invalid(plan.disjointed.invalid);
  report.set_trees_published(plan.frozen_trees);
  double sum = 0;
  int planned = 0;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const PlannedPath& robot = plan.robots[i];
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

PictureContent picture_of(const Scenario& scenario, const PathPlan& plan) {
  PictureContent content{.map = scenario.map, .edges = {}, .robots = {}};
  for (const TreeEdge& edge : plan.edges) content.edges.push_back({edge.from, edge.to, edge.robot});
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    const RobotTask& task = scenario.robots[i];
    content.robots.push_back(robot_of(task));
    content.robots.back().path = plan.robots[i].path;
  }
  return content;
}

/// Returns whether there is a plan.
bool write_grid_plan_of(const Scenario& scenario, std::span<const GridTask> tasks,
                        const GridPlanOptions& options, bool quiet) {
  const auto plan = plan_on_grid(scenario.map, tasks, scenario.seed);
  if (!plan) {
    std::cerr << "there is no joint plan on the cells of the map, or none was found\n";
    return false;
  }
  write_grid_plan(options.file, *plan,
                  options.form == grid_plan_forms[0] ? GridPlanForm::steps : GridPlanForm::agents);
  std::size_t sum = 0;
  std::size_t last = 0;
  for (const auto& cells : *plan) {
    sum += cells.size() - 1;
    last = std::max(last, cells.size() - 1);
  }
  if (!quiet) std::cout << fmt::format("joint plan on the cells: {} steps, sum of arrivals {}\n", last, sum);
  return true;
}

}  // namespace

int plan_command(const RunOptions& options, const GridPlanOptions& grid_plan) {
  ScenarioOptions read = scenario_options(options);
  if (!grid_plan.file.empty() && !read.margin) read.margin = 0;  // the cells say how close robots come
  const Scenario scenario = read_scenario(options.scenario, read);
  check_results(options, scenario, grid_plan.file);
  std::vector<GridTask> grid_tasks;
  if (!grid_plan.file.empty()) grid_tasks = grid_tasks_of(scenario);
  install_stop_signals();
  const ClearanceField field(scenario.map, scenario.margin);
  std::vector<PlanningProblem> problems;
  for (const RobotTask& task : scenario.robots)
    problems.push_back({task.start, task.goal, reference_radius(task)});
  const PathPlan plan =
      plan_paths(field, problems,
                 {.planner = chosen_planner(options),
                  .seed = scenario.seed,
                  .timeout = options.timeout,
                  .improve = options.plan_budget.value_or(std::numeric_limits<double>::infinity()),
                  .trees = chosen_trees(options)},
                 {.clock = steady_seconds, .stop = stop_requested});
  const proto::Report report = report_of(scenario, plan);
  const auto nobody_drives = [](const auto&) {};
  write_results(options, report, nobody_drives, [&] { return picture_of(scenario, plan); });
  if (!options.quiet) std::cout << report_table(report);
  const bool has_grid_plan =
      grid_plan.file.empty() || write_grid_plan_of(scenario, grid_tasks, grid_plan, options.quiet);
  return report.outcome() == "planned" && has_grid_plan ? 0 : 1;
}

}  // namespace coppice
