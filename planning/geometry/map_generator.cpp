#include "coppice/planning/map_generator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "planning/geometry/random_places.h"
#include "planning/number_text.h"
#include "planning/shuffle.h"

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

/// Adds a polygon whose corners lie at random distances around a centre.
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

/// Divides a side of the map into as many pieces of at least `least` cells as fit, with walls around them.
/// The remaining cells are spread evenly, so that the pieces fill the side.
struct Pieces {
  Pieces(int map_side, int least, int wall_width)
      : side(map_side), wall(wall_width), count((map_side - wall_width) / (least + wall_width)) {}

  int begin(int k) const { return wall + k * (side - wall) / count; }
  int end(int k) const { return begin(k + 1) - wall; }
  int size(int k) const { return end(k) - begin(k); }

  int side;
  int wall;
  int count;
};

/// Depth-first search over a grid of corridor crossings: each new crossing is joined to the one from which it
/// was found.
void make_maze(OccupancyMap& map, Random& random) {
  const Pieces columns(map.width, corridor, maze_wall);
  const Pieces rows(map.height, corridor, maze_wall);
  std::ranges::fill(map.blocked, 1);
  if (columns.count < 1 || rows.count < 1) throw std::invalid_argument("a maze needs at least 32 x 32 cells");
  const auto open = [&](int c0, int r0, int c1, int r1) {
    const int left = columns.begin(c0);
    const int top = rows.begin(r0);
    fill(map, left, top, columns.end(c1) - left, rows.end(r1) - top, 0);
  };
  std::vector<bool> seen(static_cast<std::size_t>(columns.count * rows.count), false);
  std::vector<std::pair<int, int>> way{{0, 0}};
  seen[0] = true;
  open(0, 0, 0, 0);
  while (!way.empty()) {
    const auto [c, r] = way.back();
    std::array<std::pair<int, int>, 4> next;
    std::size_t count = 0;
    for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int u = c + dc;
      const int v = r + dr;
      if (u < 0 || v < 0 || u >= columns.count || v >= rows.count ||
          seen[static_cast<std::size_t>(v * columns.count + u)])
        continue;
      next[count++] = {u, v};
    }
    if (count == 0) {
      way.pop_back();
      continue;
    }
    const auto [u, v] = next[random.index(count)];
    seen[static_cast<std::size_t>(v * columns.count + u)] = true;
    open(std::min(c, u), std::min(r, v), std::max(c, u), std::max(r, v));
    way.emplace_back(u, v);
  }
}

void make_rooms(OccupancyMap& map, Random& random) {
  const Pieces columns(map.width, room_size, room_wall);
  const Pieces rows(map.height, room_size, room_wall);
  if (columns.count < 1 || rows.count < 1) throw std::invalid_argument("rooms need at least 68 x 68 cells");
  std::ranges::fill(map.blocked, 1);
  const auto offset = [&](int size) {
    return 2 + static_cast<int>(random.index(static_cast<std::size_t>(size - door - 4)));
  };
  for (int r = 0; r < rows.count; ++r) {
    for (int c = 0; c < columns.count; ++c) {
      const int left = columns.begin(c);
      const int top = rows.begin(r);
      const int wide = columns.size(c);
      const int high = rows.size(r);
      fill(map, left, top, wide, high, 0);
      if (c + 1 < columns.count) fill(map, left + wide, top + offset(high), room_wall, door, 0);
      if (r + 1 < rows.count) fill(map, left + offset(wide), top + high, door, room_wall, 0);
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

namespace {

/// At most `count` tasks: random starts and goals are drawn up to a number of tries.
std::vector<StartAndGoal> scattered_tasks(const ReachablePart& part, int count, double apart,
                                          double least_way, Random& random) {
  SpacedPlaces starts(part.box(), apart);
  SpacedPlaces goals(part.box(), apart);
  std::vector<StartAndGoal> tasks;
  for (int tries = 0; tries < placement_tries && std::cmp_less(tasks.size(), count); ++tries) {
    const Point2 start = part.place(random.index(part.size()));
    const Point2 goal = part.place(random.index(part.size()));
    if (goal == start || (goal - start).norm() < least_way) continue;
    if (!starts.has_room(start) || !goals.has_room(goal)) continue;
    starts.add(start);
    goals.add(goal);
    tasks.push_back({start, goal});
  }
  return tasks;
}

/// Exchanges goals until each is at least `least_way` from its start, and not at it. Goals without a start
/// come last. Returns false if no such exchange is found.
bool move_apart(const std::vector<Point2>& starts, std::vector<Point2>& goals, double least_way) {
  const auto far = [&](std::size_t start, std::size_t goal) {
    if (start >= starts.size()) return true;
    const double way = (goals[goal] - starts[start]).norm();
    return way > 0 && way >= least_way;
  };
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (far(i, i)) continue;
    std::size_t j = 0;
    while (j < goals.size() && !(far(i, j) && far(j, i))) ++j;
    if (j == goals.size()) return false;
    std::swap(goals[i], goals[j]);
  }
  return true;
}

/// Tasks between the given positions of the part, which must be at least `count`.
std::vector<StartAndGoal> tasks_between(const ReachablePart& part, std::vector<Point2> places, int count,
                                        double least_way, Random& random) {
  if (places.size() == 1) return {{places[0], *draw_place(part, places[0], least_way, {}, random)}};
  shuffle(places, random);
  std::vector<Point2> goals = places;
  shuffle(goals, random);
  places.resize(static_cast<std::size_t>(count));
  while (!move_apart(places, goals, least_way)) least_way /= 2;
  std::vector<StartAndGoal> tasks;
  for (std::size_t i = 0; i < places.size(); ++i) tasks.push_back({places[i], goals[i]});
  return tasks;
}

/// The clearance at the widest position of the map, approximately.
double largest_radius(const ClearanceField& field) {
  const GridFrame& frame = field.frame();
  double most = 0;
  for (int j = 1; j < 2 * frame.height; ++j) {
    for (int i = 1; i < 2 * frame.width; ++i)
      most = std::max(most, field.lower_bound(frame.origin + frame.resolution / 2 * Point2(i, j)));
  }
  return most;
}

std::string too_large(double radius, double largest) {
  std::string text = "no robot of radius " + number_text(radius) + " fits on the map";
  if (largest > 0) text += ": the widest place is for one of about " + number_text(largest);
  return text;
}

std::string no_room(double radius, std::size_t room, int count) {
  std::string text = "room for " + std::to_string(room) + " robots of radius " + number_text(radius) +
                     " was found on the map, not for " + std::to_string(count);
  if (room == 0) text += ": each place that one fits at is closed in";
  return text;
}

}  // namespace

std::vector<StartAndGoal> random_tasks(const ClearanceField& field, int count, double radius,
                                       double least_share, Random& random, double spare) {
  const ReachablePart part = ReachablePart::largest(field, radius + spare);
  if (part.empty()) throw std::invalid_argument(too_large(radius, largest_radius(field) - spare));
  const double least_way = least_share * (part.box().upper - part.box().lower).norm();
  std::size_t room = 0;
  for (const double apart : {2 * radius + field.frame().resolution, 2 * radius}) {
    std::vector<StartAndGoal> tasks = scattered_tasks(part, count, apart, least_way, random);
    if (std::cmp_equal(tasks.size(), count)) return tasks;
    room = std::max(room, tasks.size());
  }
  const std::vector<Point2> places = packed_places(part, 2 * radius);
  room = std::max(room, places.size());
  if (part.size() == 1 || std::cmp_less(room, count))
    throw std::invalid_argument(no_room(radius, part.size() == 1 ? 0 : room, count));
  return tasks_between(part, places, count, least_way, random);
}

}  // namespace coppice
