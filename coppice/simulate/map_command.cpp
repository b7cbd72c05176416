#include <cmath>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include <fmt/format.h>

#include "coppice/commands.h"
#include "coppice/files/input_error.h"
#include "coppice/files/map_file.h"
#include "coppice/files/scenario_file.h"
#include "coppice/files/scenario_generator.h"
#include "coppice/planning/map_generator.h"
#include "files/text_file.h"

namespace coppice {

namespace {

constexpr int default_side = 512;  // cells
constexpr int default_robots = 8;
constexpr double least_way = 0.4;  // of the diagonal of the reachable area: least distance from start to goal

void refuse_size(const MapOptions& options) {
  if (options.width || options.height)
    throw InputError(
        fmt::format("--{}: {} has its own size", options.width ? "width" : "height", options.kind));
}

std::vector<StartAndGoal> draw_tasks(const OccupancyMap& map, const MapOptions& options, double radius,
                                     Random& random) {
  try {
    return random_tasks(ClearanceField(map), options.robots.value_or(default_robots), radius, least_way,
                        random);
  } catch (const std::invalid_argument& problem) {
    throw InputError(fmt::format("{}: {}", options.kind, problem.what()));
  }
}

/// Random tasks on a generated map, or on the map of a file.
Scenario random_scenario(const MapOptions& options) {
  Random random(options.seed);
  Scenario scenario{.map_name = {},
                    .map = read_or_generate_map(options.kind, options.width.value_or(default_side),
                                                options.height.value_or(default_side), random),
                    .seed = options.seed,
                    .robots = {}};
  const double cell = scenario.map.resolution;
  const double radius = options.radius.value_or(default_radius_cells * cell);
  for (const auto& [start, goal] : draw_tasks(scenario.map, options, radius, random)) {
    scenario.robots.push_back({.name = fmt::format("r{}", scenario.robots.size() + 1),
                               .start = start,
                               .goal = goal,
                               .radius = radius,
                               .max_speed = options.max_speed.value_or(default_speed_cells * cell),
                               .goal_tolerance = default_tolerance_cells * cell});
  }
  fit_margin(scenario, default_margin_radii * radius);
  return scenario;
}

/// A name of a kind means the kind, even if there is a file of that name.
bool is_kind(const std::string& name) {
  return map_kind(name) || scenario_kind(name);
}

Scenario trial_of_kind(const MapOptions& options, const ScenarioKind& kind) {
  refuse_size(options);
  if (options.radius || options.max_speed)
    throw InputError(
        fmt::format("--{}: {} has its own robots", options.radius ? "radius" : "max-speed", options.kind));
  return make_scenario(options.kind, options.robots.value_or(kind.robots), options.seed);
}

/// A name of a map and of a scenario means the map.
Scenario scenario_of_kind(const MapOptions& options) {
  if (map_kind(options.kind)) return random_scenario(options);
  if (const auto kind = scenario_kind(options.kind)) return trial_of_kind(options, *kind);
  std::error_code too_long;  // the text is too long for a file name
  if (std::filesystem::exists(options.kind, too_long)) {
    refuse_size(options);
    return random_scenario(options);
  }
  std::string names;
  for (const ScenarioKind& known : scenario_kinds()) names += (names.empty() ? "" : ", ") + known.name;
  throw InputError(fmt::format(
      "kind: \"{}\", expected a map's file, a kind of map (blank, dense, maze, room) or of scenario ({})",
      options.kind, names));
}

}  // namespace

int map_command(const MapOptions& options) {
  const std::filesystem::path file = options.output;
  if (ending_of(file) != ".json")
    throw InputError(fmt::format("{}: expected a name that ends in .json", options.output));
  Scenario scenario = scenario_of_kind(options);
  if (!is_kind(options.kind)) {
    scenario.map_name = std::filesystem::proximate(options.kind, absolute(file).parent_path()).string();
  } else {
    const std::filesystem::path map_file = std::filesystem::path(file).replace_extension(".map");
    if (std::filesystem::exists(map_file) && !std::filesystem::exists(file))
      throw InputError(fmt::format("{}: already exists, and may belong to another file than {}",
                                   map_file.string(), file.string()));
    scenario.map_name = map_file.filename().string();
    write_map(map_file, scenario.map);
  }
  write_scenario(file, scenario);
  std::cout << fmt::format("{}: {} robots on {}, {} x {} cells\n", file.string(), scenario.robots.size(),
                           scenario.map_name, scenario.map.width, scenario.map.height);
  return 0;
}

}  // namespace coppice
