#include <cmath>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include <fmt/format.h>

#include "coppice/commands.h"
#include "files/input_error.h"
#include "files/map_file.h"
#include "files/scenario_file.h"
#include "planning/map_generator.h"

namespace coppice {

namespace {

constexpr double least_way = 0.4;  // of the map's diagonal, from start to goal

}  // namespace

int map_command(const MapOptions& options) {
  const auto kind = map_kind(options.kind);
  if (!kind) throw InputError(fmt::format("kind: \"{}\", expected blank, dense, maze or room", options.kind));
  const std::filesystem::path file = options.output;
  if (file.extension() != ".json")
    throw InputError(fmt::format("{}: expected a name that ends in .json", options.output));
  const std::filesystem::path map_file = std::filesystem::path(file).replace_extension(".map");
  Random random(options.seed);
  Scenario scenario{.map_name = map_file.filename().string(), .map = {}, .seed = options.seed, .robots = {}};
  try {
    scenario.map = generate_map(*kind, options.width, options.height, random);
    const ClearanceField field(scenario.map);
    for (const auto& [start, goal] : random_tasks(field, options.robots, options.radius, least_way, random)) {
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
  write_map(map_file, scenario.map);
  write_scenario(file, scenario);
  std::cout << fmt::format("{}: {} x {} cells\n{}: {} robots\n", map_file.string(), options.width,
                           options.height, file.string(), options.robots);
  return 0;
}

}  // namespace coppice
