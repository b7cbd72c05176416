#include "simulation/fuzz_tasks.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "coppice/files/scenario_generator.h"
#include "coppice/planning/map_generator.h"
#include "planning/shuffle.h"
#include "simulation/fuzz_random.h"

namespace coppice {

namespace {

// Metres from obstacles, in addition to the room, where starts and goals are drawn.
constexpr double spare = 1;
// In cells. Robots in neighbouring cells stand apart.
constexpr double room_in_a_cell = 0.45;
constexpr std::size_t most_configurations = 20'000;  // a few milliseconds of search

/// Few robots in half of the cases: their runs are cheap, and most faults need no more.
int draw_number_of_robots(int most, Random& random) {
  return whole_number(2, chance(0.5, random) ? std::min(5, most) : most, random);
}

Scenario draw_kind(std::uint32_t seed, Random& random) {
  const auto& kinds = scenario_kinds();
  const ScenarioKind& kind = kinds[random.index(kinds.size())];
  Scenario scenario = make_scenario(kind.name, draw_number_of_robots(kind.robots, random), seed);
  scenario.map_name = kind.name;
  return scenario;
}

struct Sides {
  int width;
  int height;
};

/// Long open sites are those on which robots with slow brakes reach their speed.
Sides draw_sides(MapKind kind, Random& random) {
  const bool may_be_narrow = kind == MapKind::blank || kind == MapKind::dense;
  if (may_be_narrow && chance(0.5, random))
    return {200 * whole_number(3, 8, random), 20 * whole_number(2, 4, random)};
  const int side = 200 + 40 * whole_number(0, 5, random);
  return {side, side};
}

Scenario draw_generated_map(std::uint32_t seed, Random& random) {
  constexpr std::array maps{MapKind::blank, MapKind::dense, MapKind::maze, MapKind::room};
  constexpr std::array names{"blank", "dense", "maze", "room"};
  constexpr int most_robots_there = 12;
  const std::size_t kind = random.index(maps.size());
  const Sides sides = draw_sides(maps[kind], random);
  Scenario scenario{.map_name = names[kind],
                    .map = generate_map(maps[kind], sides.width, sides.height, random),
                    .seed = seed,
                    .robots = {}};
  const double room = random.uniform(2, 6);
  const int robots = draw_number_of_robots(most_robots_there, random);
  for (const auto& [start, goal] :
       random_tasks(ClearanceField(scenario.map), robots, room, 0.1, random, spare)) {
    scenario.robots.push_back({.name = fmt::format("r{}", scenario.robots.size() + 1),
                               .start = start,
                               .goal = goal,
                               .radius = room,
                               .goal_tolerance = 1});
  }
  return scenario;
}

OccupancyMap draw_cells(Random& random) {
  OccupancyMap map{
      .width = whole_number(4, 12, random), .height = whole_number(4, 12, random), .blocked = {}};
  const double share_blocked = random.uniform(0, 0.3);
  for (std::size_t k = 0; k < map.frame().cells(); ++k) map.blocked.push_back(chance(share_blocked, random));
  return map;
}

/// Starts and goals in cells that differ, for as many robots as there is room.
std::vector<GridTask> draw_grid_tasks(const OccupancyMap& map, Random& random) {
  std::vector<GridCell> starts;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      if (!map.is_blocked(x, y)) starts.push_back({x, y});
    }
  }
  std::vector<GridCell> goals = starts;
  shuffle(starts, random);
  shuffle(goals, random);
  const auto robots = std::min(starts.size() / 3, static_cast<std::size_t>(whole_number(2, 8, random)));
  std::vector<GridTask> tasks;
  for (std::size_t k = 0; k < robots; ++k) tasks.push_back({starts[k], goals[k]});
  return tasks;
}

FuzzTasks draw_puzzle(std::uint32_t seed, Random& random) {
  FuzzTasks drawn{.scenario = {.map_name = "cells", .map = {}, .seed = seed, .robots = {}}};
  std::vector<GridTask> tasks;
  while (!drawn.plan) {  // until there is a way for all: on open cells nearly always
    drawn.scenario.map = draw_cells(random);
    tasks = draw_grid_tasks(drawn.scenario.map, random);
    if (tasks.size() > 1) drawn.plan = plan_on_grid(drawn.scenario.map, tasks, seed, most_configurations);
  }
  for (const GridTask& task : tasks) {
    drawn.scenario.robots.push_back({.name = fmt::format("r{}", drawn.scenario.robots.size() + 1),
                                     .start = {task.start.x + 0.5, task.start.y + 0.5},
                                     .goal = {task.goal.x + 0.5, task.goal.y + 0.5},
                                     .radius = room_in_a_cell,
                                     .goal_tolerance = 0.1});
  }
  if (chance(0.3, random)) drawn.plan.reset();
  return drawn;
}

/// Cells of another size: what is drawn holds from small robots to vehicles.
void draw_scale(Scenario& scenario, Random& random) {
  if (chance(0.5, random)) return;
  const double scale = log_uniform(0.05, 2, random);
  scenario.map.resolution *= scale;
  for (RobotTask& robot : scenario.robots) {
    robot.start *= scale;
    robot.goal *= scale;
    robot.radius *= scale;
    robot.goal_tolerance *= scale;
  }
}

}  // namespace

FuzzTasks draw_tasks(std::uint32_t seed) {
  Random random = source_of(FuzzPart::tasks, seed);
  const double kind = random.uniform();
  FuzzTasks drawn = kind < 0.5   ? FuzzTasks{draw_kind(seed, random)}
                    : kind < 0.8 ? FuzzTasks{draw_generated_map(seed, random)}
                                 : draw_puzzle(seed, random);
  draw_scale(drawn.scenario, random);
  for (RobotTask& robot : drawn.scenario.robots) robot.max_speed = robot.max_acceleration = 0;
  return drawn;
}

}  // namespace coppice
