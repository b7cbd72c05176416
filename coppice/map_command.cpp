#include <cmath>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include <fmt/format.h>

#include "coppice/commands.h"
#include "files/input_error.h"
#include "files/map_file.h"
#include "files/scenario_file.h"
#include "files/scenario_generator.h"
#include "planning/map_generator.h"

namespace coppice {

namespace {

constexpr int default_robots = 8;
constexpr double least_way = 0.4;  // of the map's diagonal, from start to goal

int write_both(const std::filesystem::path& file, const std::filesystem::path& map_file,
               const Scenario& scenario) {
  write_map(map_file, scenario.map);
  write_scenario(file, scenario);
  std::cout << fmt::format("{}: {} x {} cells\n{}: {} robots\n", map_file.string(), scenario.map.width,
                           scenario.map.height, file.string(), scenario.robots.size());
  return 0;
}

}  // namespace

int map_command(const MapOptions& options) {
  const auto kind = map_kind(options.kind);
  const auto& trials = scenario_kinds();
  const auto trial = std::ranges::find(trials, options.kind, &ScenarioKind::name);
  if (!kind && trial == trials.end()) {
    std::string names = "blank, dense, maze, room";
    for (const ScenarioKind& known : trials) names += ", " + known.name;
    throw InputError(fmt::format("kind: \"{}\", expected one of {}", options.kind, names));
  }
  const std::filesystem::path file = options.output;
  if (file.extension() != ".json")
    throw InputError(fmt::format("{}: expected a name that ends in .json", options.output));
  const std::filesystem::path map_file = std::filesystem::path(file).replace_extension(".map");
  Random random(options.seed);
  if (!kind) {
    Scenario made = make_scenario(options.kind, options.robots.value_or(trial->robots), options.seed);
    made.map_name = map_file.filename().string();
    return write_both(file, map_file, made);
  }
  Scenario scenario{.map_name = map_file.filename().string(), .map = {}, .seed = options.seed, .robots = {}};
  try {
    scenario.map = generate_map(*kind, options.width, options.height, random);
    const ClearanceField field(scenario.map);
    for (const auto& [start, goal] :
         random_tasks(field, options.robots.value_or(default_robots), options.radius, least_way, random)) {
      scenario.robots.push_back({.name = fmt::format("r{}", scenario.robots.size() + 1),
                                 .start = start,
                                 .goal = goal,
                                 .radius = options.radius,
                                 .max_speed = options.max_speed,
                                 .goal_tolerance = 1});
    }
  } catch (const std::invalid_argument& problem) {
    throw InputError(problem.what());
  }
  return write_both(file, map_file, scenario);
}

}  // namespace coppice
