#include "planning/map_generator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace coppice {

namespace {

constexpr int largest_side = 16384;
constexpr double dense_share = 0.28;
constexpr int corridor = 24;
constexpr int maze_wall = 4;
constexpr int room_size = 60;
constexpr int door = 20;
constexpr int room_wall = 4;
constexpr int placement_tries = 200'000;

void fill(OccupancyMap& map, int left, int top, int width, int height, std::uint8_t value) {
  for (int j = std::max(top, 0); j < std::min(top + height, map.height); ++j) {
    for (int i = std::max(left, 0); i < std::min(left + width, map.width); ++i) {
      map.blocked[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.width) +
                  static_cast<std::size_t>(i)] = value;
    }
  }
}

/// A polygon whose corners lie at random distances around a centre.
void add_star(OccupancyMap& map, Random& random) {
  const Point2 centre(random.uniform(0, map.width), random.uniform(0, map.height));
  const std::size_t corners = 3 + random.index(5);
  const double size = random.uniform(8, 26);
  std::vector<double> reach(corners);
  for (double& r : reach) r = size * random.uniform(0.45, 1.25);
  const int extent = static_cast<int>(size * 1.25) + 1;
  for (int j = static_cast<int>(centre.y()) - extent; j <= static_cast<int>(centre.y()) + extent; ++j) {
    for (int i = static_cast<int>(centre.x()) - extent; i <= static_cast<int>(centre.x()) + extent; ++i) {
      const Point2 offset = Point2(i + 0.5, j + 0.5) - centre;
      const double turn = std::atan2(offset.y(), offset.x()) / (2 * std::numbers::pi) + 0.5;
      const double place = std::min(turn, 0x1.fffffp-1) * static_cast<double>(corners);
      const auto k = static_cast<std::size_t>(place);
      const double share = place - static_cast<double>(k);
      if (offset.norm() <= reach[k] * (1 - share) + reach[(k + 1) % corners] * share)
        fill(map, i, j, 1, 1, 1);
    }
  }
}

void make_dense(OccupancyMap& map, Random& random) {
  const auto cells = static_cast<double>(map.blocked.size());
  while (static_cast<double>(std::ranges::count(map.blocked, 1)) < dense_share * cells) add_star(map, random);
}

/// Depth-first search over a grid of corridor crossings: each new one is joined to the one that it was found
/// from.
void make_maze(OccupancyMap& map, Random& random) {
  const int pitch = corridor + maze_wall;
  const int columns = (map.width - maze_wall) / pitch;
  const int rows = (map.height - maze_wall) / pitch;
  std::ranges::fill(map.blocked, 1);
  if (columns < 1 || rows < 1) throw std::invalid_argument("a maze needs at least 32 x 32 cells");
  const auto open = [&](int c, int r, int wide, int high) {
    fill(map, maze_wall + c * pitch, maze_wall + r * pitch, wide, high, 0);
  };
  std::vector<bool> seen(static_cast<std::size_t>(columns * rows), false);
  std::vector<std::pair<int, int>> way{{0, 0}};
  seen[0] = true;
  open(0, 0, corridor, corridor);
  while (!way.empty()) {
    const auto [c, r] = way.back();
    std::array<std::pair<int, int>, 4> next;
    std::size_t count = 0;
    for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int u = c + dc;
      const int v = r + dr;
      if (u < 0 || v < 0 || u >= columns || v >= rows || seen[static_cast<std::size_t>(v * columns + u)])
        continue;
      next[count++] = {u, v};
    }
    if (count == 0) {
      way.pop_back();
      continue;
    }
    const auto [u, v] = next[random.index(count)];
    seen[static_cast<std::size_t>(v * columns + u)] = true;
    open(std::min(c, u), std::min(r, v), u == c ? corridor : pitch + corridor,
         v == r ? corridor : pitch + corridor);
    way.emplace_back(u, v);
  }
}

void make_rooms(OccupancyMap& map, Random& random) {
  const int pitch = room_size + room_wall;
  const int columns = (map.width - room_wall) / pitch;
  const int rows = (map.height - room_wall) / pitch;
  if (columns < 1 || rows < 1) throw std::invalid_argument("rooms need at least 68 x 68 cells");
  std::ranges::fill(map.blocked, 1);
  const auto offset = [&] { return 2 + static_cast<int>(random.index(room_size - door - 4)); };
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int left = room_wall + c * pitch;
      const int top = room_wall + r * pitch;
      fill(map, left, top, room_size, room_size, 0);
      if (c + 1 < columns) fill(map, left + room_size, top + offset(), room_wall, door, 0);
      if (r + 1 < rows) fill(map, left + offset(), top + room_size, door, room_wall, 0);
    }
  }
}

}  // namespace

std::optional<MapKind> map_kind(std::string_view name) {
  if (name == "blank") return MapKind::blank;
  if (name == "dense") return MapKind::dense;
  if (name == "maze") return MapKind::maze;
  if (name == "room") return MapKind::room;
  return std::nullopt;
}

OccupancyMap generate_map(MapKind kind, int width, int height, Random& random) {
  if (width < 1 || height < 1 || width > largest_side || height > largest_side) {
    throw std::invalid_argument("a map has 1 to 16384 cells a side");
  }
  OccupancyMap map;
  map.width = width;
  map.height = height;
  map.blocked.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  if (kind == MapKind::dense) make_dense(map, random);
  if (kind == MapKind::maze) make_maze(map, random);
  if (kind == MapKind::room) make_rooms(map, random);
  return map;
}

std::vector<Point2> open_places(const ClearanceField& field, double radius) {
  const GridFrame& frame = field.frame();
  const auto width = static_cast<std::size_t>(frame.width);
  const auto centre = [&](std::size_t cell) {
    return Point2(frame.origin + frame.resolution * Point2(static_cast<double>(cell % width) + 0.5,
                                                           static_cast<double>(cell / width) + 0.5));
  };
  std::vector<std::uint8_t> open(frame.cells());
  for (std::size_t cell = 0; cell < open.size(); ++cell) open[cell] = field.is_free(centre(cell), radius);
  std::vector<std::size_t> best;
  for (std::size_t seed = 0; seed < open.size(); ++seed) {
    if (open[seed] == 0) continue;
    std::vector<std::size_t> part{seed};
    open[seed] = 0;
    const auto visit = [&](bool there, std::size_t cell) {
      if (!there || open[cell] == 0) return;
      open[cell] = 0;
      part.push_back(cell);
    };
    for (std::size_t k = 0; k < part.size(); ++k) {
      const std::size_t cell = part[k];
      visit(cell % width > 0, cell - 1);
      visit(cell % width + 1 < width, cell + 1);
      visit(cell >= width, cell - width);
      visit(cell + width < open.size(), cell + width);
    }
    if (part.size() > best.size()) best = std::move(part);
  }
  std::ranges::sort(best);
  std::vector<Point2> centres;
  for (const std::size_t cell : best) centres.push_back(centre(cell));
  return centres;
}

std::vector<StartAndGoal> random_tasks(const ClearanceField& field, int count, double radius,
                                       double least_share, Random& random) {
  const double cell = field.frame().resolution;
  const std::vector<Point2> places = open_places(field, radius + cell);
  if (places.empty()) throw std::invalid_argument("no robot of this radius fits on the map");
  const Box<2> box = field.bounds();
  const double least_way = least_share * (box.upper - box.lower).norm();
  const double apart = 2 * radius + cell;
  std::vector<StartAndGoal> tasks;
  const auto crowded = [&](Point2 StartAndGoal::*place, const Point2& p) {
    return std::ranges::any_of(tasks, [&](const StartAndGoal& t) { return (t.*place - p).norm() < apart; });
  };
  for (int tries = 0; static_cast<int>(tasks.size()) < count; ++tries) {
    if (tries == placement_tries) throw std::invalid_argument("no room for so many robots on the map");
    const Point2 start = places[random.index(places.size())];
    const Point2 goal = places[random.index(places.size())];
    if ((goal - start).norm() < least_way) continue;
    if (crowded(&StartAndGoal::start, start) || crowded(&StartAndGoal::goal, goal)) continue;
    tasks.push_back({start, goal});
  }
  return tasks;
}

}  // namespace coppice
