#include "files/run_options.h"

#include <exception>
#include <filesystem>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "files/input_error.h"
#include "files/number_check.h"
#include "files/output_check.h"
#include "files/report_file.h"
#include "planning/quantities.h"

namespace coppice {

void add_run_options(CLI::App& command, RunOptions& options) {
  command.add_option("scenario", options.scenario, "scenario (.json) or Moving AI scenario (.scen)")
      ->required();
  command.add_option("--map", options.overrides.map,
                     "file of the map, instead of the one that the scenario names");
  command.add_option("--robots", options.overrides.robots, "only the first N robots")
      ->check(CLI::Range(1, 100000));
  command.add_option("--radius", options.overrides.radius, "of every robot, metres")
      ->check(number_above_zero());
  command.add_option("--max-speed", options.overrides.max_speed, "of every robot, m/s")
      ->check(number_above_zero());
  command.add_option("--seed", options.overrides.seed, "of every random choice");
  command.add_option("--time-scale", options.time_scale, "fleet seconds a wall second")
      ->check(number_between(least_quantity, largest_time_scale));
  command.add_option("--timeout", options.timeout, "fleet seconds until the run ends")
      ->check(number_above_zero());
  command
      .add_option("--lifelong", options.lifelong,
                  "fleet seconds in which every robot that arrives gets a new goal, drawn at random")
      ->check(number_not_negative());
  command
      .add_option("--plan-budget", options.plan_budget,
                  "seconds to look for shorter paths after the first; 0: none")
      ->check(number_between(0, largest_quantity));
  command.add_option("--report", options.report, "write the report (JSON)")->check(output_file());
  command.add_option("--trajectory", options.trajectory, "write every control step (CSV)")
      ->check(output_file());
  command.add_option("--picture", options.picture, "write a picture (SVG)")->check(picture_file());
  command
      .add_option("--planner", options.planner,
                  "ma-rrdt: trees shared by all (MA-RRdT*); rrdt: each robot alone (RRdT*); rrt-star: RRT*")
      ->check(CLI::IsMember(std::vector<std::string>(planner_names.begin(), planner_names.end())));
  command.add_flag_callback(
      "--no-sharing", [&options] { options.planner = planner_names[1]; }, "the same as --planner rrdt");
  command.add_flag("--quiet", options.quiet, "print neither progress nor the report");
}

PlannerKind chosen_planner(const RunOptions& options) {
  return planner_kind(options.planner).value();  // checked when the option was read
}

void check_results(const RunOptions& options, const Scenario& scenario, const std::string& recording) {
  namespace fs = std::filesystem;
  std::map<fs::path, std::string> names;
  if (!options.scenario.empty()) {
    names = {{fs::weakly_canonical(options.scenario), options.scenario},
             {fs::weakly_canonical(scenario.map_file), scenario.map_file}};
  }
  for (const std::string& file : {recording, options.report, options.trajectory, options.picture}) {
    const bool is_device = fs::exists(file) && !fs::is_regular_file(file);
    if (file.empty() || is_device) continue;
    const auto [other, fresh] = names.try_emplace(fs::weakly_canonical(file), file);
    if (!fresh) throw InputError(fmt::format("{} is to be two files: it is {}, too", file, other->second));
  }
}

void write_results(const RunOptions& options, const proto::Report& report, const TrackParts& tracks,
                   const std::function<PictureContent()>& picture) {
  std::string problems;
  const auto attempt = [&](const std::string& file, const auto& write) {
    if (file.empty()) return;
    try {
      write(file);
    } catch (const std::exception& problem) {
      problems += (problems.empty() ? "" : "; ") + std::string(problem.what());
    }
  };
  attempt(options.report, [&](const std::string& file) { write_report(file, report); });
  attempt(options.trajectory, [&](const std::string& file) { write_trajectory(file, tracks); });
  attempt(options.picture, [&](const std::string& file) { write_picture(file, picture()); });
  if (!problems.empty()) throw InputError(problems);
}

}  // namespace coppice
