#include "files/run_options.h"

#include <array>
#include <exception>
#include <filesystem>
#include <map>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "coppice/files/plan_file.h"
#include "files/number_check.h"
#include "files/output_check.h"
#include "files/report_file.h"
#include "files/report_terms.h"
#include "planning/quantities.h"

namespace coppice {

namespace {

constexpr std::array<std::string_view, 2> rounds_names{"on", "off"};

void add_forest_option(CLI::App& command, RunOptions& options) {
  command
      .add_option(
          "--forest", options.forest,
          "ahead: the shared trees cover the map before the missions go out; together: they grow while "
          "the robots plan, as in the paper")
      ->check(CLI::IsMember(std::vector<std::string>(forest_names.begin(), forest_names.end())));
}

void add_coordination_options(CLI::App& command, RunOptions& options) {
  command
      .add_option(
          "--coordination", options.coordination,
          "reservations: robots reserve trajectories around each other; rvo: they set off along their "
          "paths, and avoid each other by reciprocal velocity obstacles, as in the paper")
      ->check(CLI::IsMember(std::vector<std::string>(coordination_names.begin(), coordination_names.end())));
  command
      .add_option("--rounds", options.rounds,
                  "with --coordination rvo: whether robots that get stuck make joint plans; on or off")
      ->check(CLI::IsMember(std::vector<std::string>(rounds_names.begin(), rounds_names.end())))
      ->default_str("on");
}

/// docs/planning.md explains them.
void add_tree_options(CLI::App& command, RunOptions& options) {
  command.option_defaults()->group("Trees");
  TreeParameters& trees = options.trees;
  const char* const from_the_map = "follows from the map";
  command.add_option("--epsilon", trees.epsilon, "longest step of a tree, metres")
      ->check(number_between(least_quantity, largest_quantity))
      ->default_str(from_the_map);
  command.add_option("--disjointed-trees", trees.disjointed_trees, "disjointed trees that grow at a time")
      ->check(whole_number_between<std::uint32_t>(1, most_disjointed_trees))
      ->default_str(from_the_map);
  command
      .add_option("--kappa", trees.kappa, "concentration of directions around the last success; 0: uniform")
      ->check(number_between(0, largest_kappa));
  command.add_option("--failure-factor", trees.failure_factor, "of a tree's weight, for each failed sample")
      ->check(number_between(least_failure_factor, largest_failure_factor));
  command
      .add_option("--restart-weight", trees.restart_weight, "weight below which a tree restarts; 10 at first")
      ->check(number_between(least_restart_weight, full_weight));
  command
      .add_option("--spacing", trees.spacing,
                  "distance, in units of epsilon, within which nodes bring little; 0: each counts")
      ->check(number_between(0, largest_spacing));
  command
      .add_option("--restarts", options.restarts,
                  "even: disjointed trees restart at evenly spread points; random: at random points")
      ->check(CLI::IsMember(std::vector<std::string>(restarts_names.begin(), restarts_names.end())));
}

/// When the run ends, and what else a standing fleet does not have.
void add_end_options(CLI::App& command, RunOptions& options, bool is_of_plan) {
  command
      .add_option("--timeout", options.timeout,
                  is_of_plan ? "seconds until planning ends" : "fleet seconds until the run ends")
      ->check(number_above_zero());
  command
      .add_option(
          "--lifelong", options.lifelong,
          "fleet seconds in which every robot that arrives gets a new goal that it can reach; 0: none; "
          "plan gives none")
      ->check(number_not_negative());
  if (!is_of_plan) {
    add_forest_option(command, options);
    command
        .add_option("--plan", options.plan,
                    "joint plan of a grid planner that the robots are to carry out (docs/planning.md)")
        ->type_name("FILE")
        ->default_str("none");
  }
}

}  // namespace

void add_run_options(CLI::App& command, RunOptions& options, Progression progression) {
  const bool is_of_plan = progression == Progression::paths_only;
  command.add_option("scenario", options.scenario, "a scenario (.json) or a Moving AI scenario (.scen)")
      ->required();
  command.add_option("--map", options.overrides.map, "map file, if it is not where the scenario says")
      ->type_name("FILE")
      ->default_str("the scenario's");
  command.option_defaults()->group("Robots and planning");
  command.add_option("--robots", options.overrides.robots, "only the first N robots")
      ->check(whole_number_between(1, 100000))
      ->default_str("all");
  command.add_option("--radius", options.overrides.radius, "radius of every robot, metres")
      ->check(number_above_zero())
      ->default_str("the scenario's, or 5 cells of the map");
  command
      .add_option("--max-speed", options.overrides.max_speed,
                  "maximum speed of every robot, metres per second")
      ->check(number_above_zero())
      ->default_str("the scenario's, or 20 cells of the map a second");
  command
      .add_option("--kinematics", options.overrides.kinematics,
                  "holonomic: every robot moves in any direction at once; differential: it turns")
      ->check(CLI::IsMember(std::vector<std::string>{"holonomic", "differential"}))
      ->default_str("the scenario's, or holonomic");
  command
      .add_option("--margin", options.overrides.margin,
                  "metres that robots keep from obstacles beyond their radius, and from each other, where "
                  "there is room")
      ->check(number_not_negative())
      ->default_str("the scenario's, or a tenth of the least radius");
  command.add_option("--seed", options.overrides.seed, "seed of all random choices")
      ->check(a_seed())
      ->default_str("the scenario's, or 1");
  command
      .add_option("--planner", options.planner,
                  "ma-rrdt: trees shared by all (MA-RRdT*); rrdt: each robot alone (RRdT*); rrt-star: RRT*")
      ->check(CLI::IsMember(std::vector<std::string>(planner_names.begin(), planner_names.end())));
  command.add_flag_callback(
      "--no-sharing", [&options] { options.planner = planner_names[1]; }, "the same as --planner rrdt");
  command
      .add_option("--plan-budget", options.plan_budget,
                  "seconds to look for shorter paths after the first ones; 0: none")
      ->check(number_between(0, largest_quantity))
      ->default_str(is_of_plan ? "until no shorter path turns up" : fmt::format("{}", default_plan_budget));
  command
      .add_option("--time-scale", options.time_scale,
                  "fleet seconds per wall-clock second; simulate and plan do not wait for the clock")
      ->check(number_between(least_quantity, largest_time_scale))
      ->default_str(progression == Progression::many_processes || progression == Progression::standing
                        ? "1, or with more than 25 robots a processor (25 x processors / robots)^1.5"
                        : "1");
  if (!is_of_plan) add_coordination_options(command, options);
  if (progression == Progression::standing) {
    add_forest_option(command, options);
  } else {
    add_end_options(command, options, is_of_plan);
  }
  add_tree_options(command, options);
  command.option_defaults()->group("Results");
  const auto file = [&](const char* name, std::string& chosen, const char* what,
                        const CLI::Validator& check) {
    command.add_option(name, chosen, what)->check(check)->default_str("not written");
  };
  file("--report", options.report, "writes the report (JSON; coppice help report explains it)",
       output_file());
  file("--trajectory", options.trajectory, "writes every control step (CSV)", output_file());
  file("--picture", options.picture, "writes a picture (SVG)", picture_file());
  command.add_flag("--quiet", options.quiet, "prints neither progress nor the report");
  command.footer(terms_of_table());
}

ScenarioOptions scenario_options(const RunOptions& options) {
  ScenarioOptions read = options.overrides;
  if (!options.plan.empty() && !read.margin) read.margin = 0;
  read.is_site = options.serves;
  return read;
}

std::vector<Trajectory> chosen_plan(const RunOptions& options, const Scenario& scenario) {
  if (options.plan.empty()) return {};
  if (!reserves(chosen_coordination(options)))
    throw InputError("--plan: goes with --coordination reservations only");
  return read_plan(options.plan, scenario);
}

PlannerKind chosen_planner(const RunOptions& options) {
  return planner_kind(options.planner).value();  // the option's validator has checked the name
}

ForestStart chosen_forest(const RunOptions& options) {
  return options.forest == forest_names[0] ? ForestStart::ahead : ForestStart::together;
}

Coordination chosen_coordination(const RunOptions& options) {
  if (options.coordination == coordination_names[0]) {
    if (options.rounds)
      throw InputError(fmt::format("--rounds {}: goes with --coordination rvo only", *options.rounds));
    return Coordination::reservations;
  }
  return options.rounds == rounds_names[1] ? Coordination::rvo_without_rounds : Coordination::rvo;
}

TreeParameters chosen_trees(const RunOptions& options) {
  TreeParameters trees = options.trees;
  trees.restarts = options.restarts == restarts_names[0] ? Restarts::even : Restarts::random;
  return trees;
}

namespace {

/// The name by which two names of one file are found. A pipe has none.
std::filesystem::path unique_name(const std::filesystem::path& file) {
  std::error_code problem;
  const std::filesystem::path name = std::filesystem::weakly_canonical(file, problem);
  return problem ? std::filesystem::absolute(file) : name;
}

}  // namespace

void check_results(const RunOptions& options, const Scenario& scenario, const std::string& recording) {
  namespace fs = std::filesystem;
  std::map<fs::path, std::string> names;
  if (!options.scenario.empty()) {
    names = {{unique_name(options.scenario), options.scenario},
             {unique_name(scenario.map_file), scenario.map_file}};
  }
  if (!options.plan.empty()) names.emplace(unique_name(options.plan), options.plan);
  for (const std::string& file : {recording, options.report, options.trajectory, options.picture}) {
    const bool is_device = fs::exists(file) && !fs::is_regular_file(file);
    if (file.empty() || is_device) continue;
    const auto [other, fresh] = names.try_emplace(unique_name(file), file);
    if (!fresh)
      throw InputError(fmt::format("{} is named for two files: it is also {}", file, other->second));
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
