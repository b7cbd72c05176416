#include "coppice/files/scenario_generator.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "coppice/files/input_error.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/map_generator.h"
#include "coppice/planning/random.h"
#include "planning/quantities.h"
#include "planning/shuffle.h"

namespace coppice {

namespace {

constexpr double radius = 5;
constexpr double speed = 20;
// Metres from obstacles, in addition to the radius, where starts and goals are drawn.
constexpr double spare = 1;

OccupancyMap filled(int width, int height, bool blocked) {
  OccupancyMap map{.width = width, .height = height, .blocked = {}};
  map.blocked.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), blocked ? 1 : 0);
  return map;
}

/// Sets a rectangle of cells, with its first corner at (i, j), free or blocked.
void set(OccupancyMap& map, int i, int j, int width, int height, bool blocked) {
  for (int y = j; y < j + height; ++y) {
    for (int x = i; x < i + width; ++x)
      map.blocked[static_cast<std::size_t>(y * map.width + x)] = blocked ? 1 : 0;
  }
}

void add_robot(Scenario& scenario, const Point2& start, const Point2& goal, double r = radius,
               double v = speed) {
  scenario.robots.push_back(
      {fmt::format("r{}", scenario.robots.size() + 1), start, goal, r, v, 2 * v, scenario.map.resolution});
}

/// The points of a lattice in a rectangle, shuffled.
std::vector<Point2> places(const Point2& lower, const Point2& upper, double apart, Random& random) {
  std::vector<Point2> result;
  for (double y = lower.y(); y <= upper.y(); y += apart) {
    for (double x = lower.x(); x <= upper.x(); x += apart) result.emplace_back(x, y);
  }
  shuffle(result, random);
  return result;
}

/// Robots on a circle; each goal is opposite its start.
void circle_swap(Scenario& scenario, int robots, Random& random) {
  const double ring = std::max(100.0, robots * 13.0 / (2 * std::numbers::pi));
  const int side = 2 * static_cast<int>(ring) + 60;
  scenario.map = filled(side, side, false);
  const Point2 centre(side / 2.0, side / 2.0);
  const double turn = random.uniform(0, 2 * std::numbers::pi);
  for (int k = 0; k < robots; ++k) {
    const double angle = turn + 2 * std::numbers::pi * k / robots;
    const Point2 out = ring * Point2(std::cos(angle), std::sin(angle));
    add_robot(scenario, centre + out, centre - out);
  }
}

/// Two robots that meet head-on in a corridor with one pocket at its side.
void pocket(Scenario& scenario, int width, Random& random) {
  const int length = 220;
  scenario.map = filled(length + 20, width + 50, true);
  set(scenario.map, 10, 10, length, width, false);
  const int at = 40 + static_cast<int>(random.index(120));
  set(scenario.map, at, 10 + width, 20, 16, false);
  const double y = 10 + width / 2.0;
  add_robot(scenario, {16, y}, {length + 4.0, y});
  add_robot(scenario, {length + 4.0, y}, {16, y});
}

/// Two robots that meet head-on in a corridor of a closed loop: the way round is long.
void loop(Scenario& scenario, int width, Random& random) {
  const int length = 220;
  const int height = 100 + static_cast<int>(random.index(60));
  scenario.map = filled(length + 20, height + 20, true);
  set(scenario.map, 10, 10, length, height, false);
  set(scenario.map, 10 + width, 10 + width, length - 2 * width, height - 2 * width, true);
  const double y = 10 + width / 2.0;
  add_robot(scenario, {40, y}, {length - 20.0, y});
  add_robot(scenario, {length - 20.0, y}, {40, y});
}

/// Two halls that a passage connects. Half of the robots start in each hall; all goals are in the other hall.
void halls(Scenario& scenario, int robots, int width, int length, Random& random) {
  const int hall = 120;
  scenario.map = filled(2 * hall + length, 160, false);
  set(scenario.map, hall, 0, length, 160, true);
  set(scenario.map, hall, 80 - width / 2, length, width, false);
  const double right = hall + length;
  const auto left_starts = places({10, 10}, {hall - 20.0, 150}, 14, random);
  const auto right_starts = places({right + 20, 10}, {right + hall - 10, 150}, 14, random);
  const auto left_goals = places({10, 10}, {hall - 20.0, 150}, 14, random);
  const auto right_goals = places({right + 20, 10}, {right + hall - 10, 150}, 14, random);
  for (int k = 0; k < robots; ++k) {
    const auto n = static_cast<std::size_t>(k / 2);
    if (k % 2 == 0) {
      add_robot(scenario, left_starts[n], right_goals[n]);
    } else {
      add_robot(scenario, right_starts[n], left_goals[n]);
    }
  }
}

/// Two corridors that cross. A quarter of the robots starts in each arm; all goals are in the opposite arm.
void crossing(Scenario& scenario, int robots, Random& random) {
  constexpr int side = 420;
  constexpr int width = 24;
  scenario.map = filled(side, side, true);
  set(scenario.map, 0, (side - width) / 2, side, width, false);
  set(scenario.map, (side - width) / 2, 0, width, side, false);
  const double middle = side / 2.0;
  std::vector<double> order;
  for (int k = 0; k < (robots + 3) / 4; ++k) order.push_back(k);
  const auto shuffled = [&] {
    std::vector<double> s = order;
    shuffle(s, random);
    return s;
  };
  // Two abreast, rows 12 m apart, from the ends of the arms inwards.
  const auto place = [&](double k) {
    return Point2(8 + 12 * std::floor(k / 2), k - 2 * std::floor(k / 2) < 1 ? -6 : 6);
  };
  for (int arm = 0; arm < 4; ++arm) {
    const std::vector<double> goals = shuffled();
    for (std::size_t k = 0; k < order.size() && static_cast<int>(scenario.robots.size()) < robots; ++k) {
      const Point2 s = place(order[k]);
      const Point2 g = place(goals[k]);
      const auto at = [&](const Point2& p, bool start) {
        const double along = (arm % 2 == 0) == start ? p.x() : side - p.x();
        return arm < 2 ? Point2(along, middle + p.y()) : Point2(middle + p.y(), along);
      };
      add_robot(scenario, at(s, true), at(g, false));
    }
  }
}

/// Random starts and goals on a generated map.
void random_goals(Scenario& scenario, MapKind kind, int robots, Random& random) {
  scenario.map = generate_map(kind, 512, 512, random);
  for (const auto& [start, goal] :
       random_tasks(ClearanceField(scenario.map), robots, radius, 0.1, random, spare))
    add_robot(scenario, start, goal);
}

/// Aisles that are one robot wide between shelves, open at both ends. Starts and goals are in the aisles.
void warehouse(Scenario& scenario, int robots, Random& random) {
  constexpr int aisle = 12;
  constexpr int shelf = 8;
  constexpr int shelf_length = 90;
  constexpr int lane = 30;
  const int aisles = 10;
  const int width = aisles * (aisle + shelf) + shelf + 2 * lane;
  scenario.map = filled(width, 2 * shelf_length + 3 * lane, false);
  for (int row = 0; row < 2; ++row) {
    for (int k = 0; k <= aisles; ++k)
      set(scenario.map, lane + k * (aisle + shelf), lane + row * (shelf_length + lane), shelf, shelf_length,
          true);
  }
  std::vector<Point2> slots;
  for (int row = 0; row < 2; ++row) {
    for (int k = 0; k < aisles; ++k) {
      for (int n = 0; n < 4; ++n)
        slots.emplace_back(lane + shelf + k * (aisle + shelf) + aisle / 2.0,
                           lane + row * (shelf_length + lane) + 12 + 22 * n);
    }
  }
  std::vector<Point2> goals = slots;
  shuffle(goals, random);
  std::vector<Point2> starts = slots;
  shuffle(starts, random);
  for (int k = 0; k < robots; ++k)
    add_robot(scenario, starts[static_cast<std::size_t>(k)], goals[static_cast<std::size_t>(k)]);
}

/// Goals in a row in a dead end. The robot with the deepest goal starts furthest away.
void dead_end(Scenario& scenario, int robots, Random& random) {
  const int depth = 14 * robots + 10;
  scenario.map = filled(140 + depth, 100, true);
  set(scenario.map, 0, 0, 140, 100, false);
  const int j = 20 + static_cast<int>(random.index(50));
  set(scenario.map, 140, j, depth, 12, false);
  for (int k = 0; k < robots; ++k) add_robot(scenario, {130.0 - 13 * k, j + 6.0}, {150.0 + 14 * k, j + 6.0});
}

/// Robots of very different sizes and speeds among dense obstacles.
void mixed(Scenario& scenario, int robots, Random& random) {
  scenario.map = generate_map(MapKind::dense, 512, 512, random);
  // Starts and goals are drawn for the largest radius, so they fit every robot.
  for (const auto& [start, goal] : random_tasks(ClearanceField(scenario.map), robots, 8, 0.1, random, spare))
    add_robot(scenario, start, goal, random.uniform(2, 8), random.uniform(5, 20));
}

// Drawing the starts and goals shows whether there is room for so many.
constexpr int most_by_chance = most_robots;

using Maker = std::function<void(Scenario&, int, Random&)>;
struct Entry {
  ScenarioKind kind;
  Maker make;
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{
      {{"circle", 10, 2000, "circle swap"}, circle_swap},
      {{"pocket-14", 2, 2, "head-on in a corridor 14 wide, a pocket at its side"},
       [](Scenario& s, int, Random& r) { pocket(s, 14, r); }},
      {{"pocket-18", 2, 2, "the same, 18 wide"}, [](Scenario& s, int, Random& r) { pocket(s, 18, r); }},
      {{"loop-14", 2, 2, "head-on in a corridor 14 wide, a long way round"},
       [](Scenario& s, int, Random& r) { loop(s, 14, r); }},
      {{"loop-18", 2, 2, "the same, 18 wide"}, [](Scenario& s, int, Random& r) { loop(s, 18, r); }},
      {{"corridor-24", 10, 154, "half against half through a corridor 24 wide"},
       [](Scenario& s, int n, Random& r) { halls(s, n, 24, 160, r); }},
      {{"corridor-40", 20, 154, "the same, 40 wide"},
       [](Scenario& s, int n, Random& r) { halls(s, n, 40, 160, r); }},
      {{"door-14", 10, 154, "half against half through a door 14 wide"},
       [](Scenario& s, int n, Random& r) { halls(s, n, 14, 4, r); }},
      {{"door-20", 20, 154, "the same, 20 wide"},
       [](Scenario& s, int n, Random& r) { halls(s, n, 20, 4, r); }},
      {{"crossing", 40, 128, "four streams where two corridors 24 wide cross"}, crossing},
      {{"rooms-traffic", 20, most_by_chance, "rooms, anywhere to anywhere", "rooms"},
       [](Scenario& s, int n, Random& r) { random_goals(s, MapKind::room, n, r); }},
      {{"maze-traffic", 10, most_by_chance, "a maze, anywhere to anywhere", "maze"},
       [](Scenario& s, int n, Random& r) { random_goals(s, MapKind::maze, n, r); }},
      {{"warehouse", 30, 80, "aisles one robot wide, from slot to slot"}, warehouse},
      {{"dead-end", 6, 10, "a dead end that fills in the wrong order"}, dead_end},
      {{"mixed", 30, most_by_chance, "radii 2 to 8, speeds 5 to 20, dense obstacles"}, mixed},
  };
  return all;
}

}  // namespace

const std::vector<ScenarioKind>& scenario_kinds() {
  static const std::vector<ScenarioKind> kinds = [] {
    std::vector<ScenarioKind> result;
    for (const Entry& entry : entries()) result.push_back(entry.kind);
    return result;
  }();
  return kinds;
}

std::optional<ScenarioKind> scenario_kind(const std::string& name) {
  const auto known = std::ranges::find_if(scenario_kinds(), [&](const ScenarioKind& kind) {
    return !name.empty() && (kind.name == name || kind.former_name == name);
  });
  return known != scenario_kinds().end() ? std::optional(*known) : std::nullopt;
}

Scenario make_scenario(const std::string& name, int robots, std::uint32_t seed) {
  const auto kind = scenario_kind(name);
  if (!kind) throw InputError(fmt::format("there is no kind of scenario \"{}\"", name));
  if (robots > kind->most)
    throw InputError(fmt::format("{} has room for {} robots, not for {}", name, kind->most, robots));
  const auto entry = std::ranges::find(
      entries(), kind->name, [](const Entry& e) -> const auto& { return e.kind.name; });
  Random random(seed);
  Scenario scenario{.map_name = kind->name + ".map", .map = {}, .seed = seed, .robots = {}};
  try {
    entry->make(scenario, robots, random);
  } catch (const std::invalid_argument& problem) {
    throw InputError(fmt::format("{}: {}", name, problem.what()));
  }
  return scenario;
}

}  // namespace coppice
