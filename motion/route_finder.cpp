#include "motion/route_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "motion/free_way.h"
#include "motion/segments.h"
#include "planning/path_shortening.h"

namespace coppice {

namespace {

// Beyond the radii, as a share of the own one: what a robot that follows its route may stray by.
constexpr double comfort = 0.1;
constexpr double crossing_factor = 8;  // of the length, where a route leads through a disc that may move
constexpr double avoided_detour = 30;  // radii that a refuge may be further away for lying in nobody's way
constexpr double rounding = 1e-9;      // metres
constexpr std::uint8_t unknown = 0;
constexpr std::uint8_t blocked = 1;
constexpr std::uint8_t free_ = 2;

struct Step {
  int di;
  int dj;
};
// The first four belong to the vertex that they start from, the others to the one that they lead to.
constexpr std::array<Step, 8> steps{{{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

/// Half a cell times the largest whole number that keeps it at most `wanted`; at least half a cell.
double on_half_cells(double wanted, double resolution) {
  const double half = resolution / 2;
  return half * std::max(1.0, std::floor(wanted / half));
}

/// The free space without the discs that stand in it.
template <class Obstacle>
struct SpaceWithDiscs {
  static constexpr int dimension = 2;
  const ClearanceField& field;
  std::span<const Obstacle> discs;

  Box<2> bounds() const { return field.bounds(); }
  bool is_free(const Point2& p, double radius) const { return segment_free(p, p, radius); }
  bool segment_free(const Point2& a, const Point2& b, double radius) const {
    return std::ranges::all_of(discs,
                               [&](const Obstacle& o) {
                                 return point_segment_distance(o.centre, a, b) >= o.distance - rounding;
                               }) &&
           way_free(field, a, b, radius);
  }
};

}  // namespace

RouteFinder::RouteFinder(const ClearanceField& field, double radius, double spacing)
    : field_(field), radius_(radius), spacing_(on_half_cells(spacing, field.map().resolution)) {
  const Box<2> box = field.bounds();
  origin_ = box.lower;
  columns_ = static_cast<int>((box.upper.x() - box.lower.x()) / spacing_) + 1;
  rows_ = static_cast<int>((box.upper.y() - box.lower.y()) / spacing_) + 1;
  const auto vertices = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  labels_.resize(vertices + 1);  // the last one is the goal
  marked_.assign(vertices, 0);
  mark_.assign(vertices, 0);
  known_vertex_.assign(vertices, unknown);
  known_edges_.assign(vertices, unknown);
}

Point2 RouteFinder::at(Vertex v) const {
  const int i = static_cast<int>(v) % columns_;
  const int j = static_cast<int>(v) / columns_;
  return origin_ + spacing_ * Point2(i, j);
}

bool RouteFinder::vertex_free(Vertex v) {
  if (known_vertex_[v] == unknown) known_vertex_[v] = field_.is_free(at(v), radius_) ? free_ : blocked;
  return known_vertex_[v] == free_;
}

bool RouteFinder::edge_free(Vertex v, Vertex w, int direction) {
  if (direction >= 4) {
    std::swap(v, w);
    direction -= 4;
  }
  const int shift = 2 * direction;
  std::uint8_t known = (known_edges_[v] >> shift) & 3;
  if (known == unknown) {
    known = field_.segment_free(at(v), at(w), radius_) ? free_ : blocked;
    known_edges_[v] |= static_cast<std::uint8_t>(known << shift);
  }
  return known == free_;
}

void RouteFinder::begin_search() {
  if (++search_ != 0) return;
  // The count has wrapped round: no label may look like one of this search.
  std::ranges::fill(marked_, 0);
  std::ranges::fill(labels_, Label{});
  search_ = 1;
}

/// Marks the vertices within `distance` of the segment from a to b.
void RouteFinder::mark(const Point2& a, const Point2& b, double distance, Mark what) {
  const Point2 lower = (a.cwiseMin(b) - origin_).array() - distance;
  const Point2 upper = (a.cwiseMax(b) - origin_).array() + distance;
  const auto cell = [&](double metres, int most) {
    return std::clamp(static_cast<int>(std::floor(metres / spacing_)), 0, most);
  };
  for (int j = cell(lower.y(), rows_ - 1); j <= cell(upper.y() + spacing_, rows_ - 1); ++j) {
    for (int i = cell(lower.x(), columns_ - 1); i <= cell(upper.x() + spacing_, columns_ - 1); ++i) {
      const auto v = static_cast<Vertex>(j * columns_ + i);
      if (point_segment_distance(at(v), a, b) >= distance) continue;
      mark_[v] = static_cast<std::uint8_t>(marks(v) | what);
      marked_[v] = search_;
    }
  }
}

std::vector<RouteFinder::Obstacle> RouteFinder::obstacles(std::span<const Disc> discs, const Point2& from,
                                                          const std::optional<Point2>& to) const {
  // Where an end lies closer to a disc than is comfortable, the way there may use up half of what is left.
  const auto at_end = [&](const Point2& end, const Disc& disc, double touching) {
    const double gap = (end - disc.centre).norm() - touching;
    return touching + (gap > 0 ? gap / 2 : gap);
  };
  std::vector<Obstacle> result;
  for (const Disc& disc : discs) {
    const double touching = radius_ + disc.radius + standing_gap;
    double distance = touching + comfort * radius_;
    if ((from - disc.centre).norm() < distance) distance = at_end(from, disc, touching);
    if (to && (*to - disc.centre).norm() < distance)
      distance = std::min(distance, at_end(*to, disc, touching));
    result.push_back({disc.centre, distance});
  }
  return result;
}

/// Calls fn(vertex, metres) for the vertices around p that lead there in a straight line.
template <class Fn>
void RouteFinder::for_each_link(const Point2& p, std::span<const Obstacle> obstacles, Fn&& fn) {
  const Point2 q = (p - origin_) / spacing_;
  const int i0 = static_cast<int>(std::floor(q.x()));
  const int j0 = static_cast<int>(std::floor(q.y()));
  const SpaceWithDiscs<Obstacle> space{field_, obstacles};
  for (int j = std::max(0, j0 - 1); j <= std::min(rows_ - 1, j0 + 2); ++j) {
    for (int i = std::max(0, i0 - 1); i <= std::min(columns_ - 1, i0 + 2); ++i) {
      const auto v = static_cast<Vertex>(j * columns_ + i);
      if (!vertex_free(v) || (marks(v) & wall) != 0 || !space.segment_free(p, at(v), radius_)) continue;
      fn(v, (at(v) - p).norm());
    }
  }
}

/// Calls fn(vertex, metres) for the vertices that an edge leads to.
template <class Fn>
void RouteFinder::for_each_neighbour(Vertex v, Fn&& fn) {
  const int i = static_cast<int>(v) % columns_;
  const int j = static_cast<int>(v) / columns_;
  for (int d = 0; d < 8; ++d) {
    const auto [di, dj] = steps[static_cast<std::size_t>(d)];
    if (i + di < 0 || i + di >= columns_ || j + dj < 0 || j + dj >= rows_) continue;
    const auto w = static_cast<Vertex>((j + dj) * columns_ + i + di);
    if ((marks(w) & wall) != 0 || !vertex_free(w) || !edge_free(v, w, d)) continue;
    fn(w, d % 2 == 0 ? spacing_ : spacing_ * std::numbers::sqrt2);
  }
}

/// A* to the goal's place, or Dijkstra's search to the nearest place that no mark forbids.
Path RouteFinder::search(const Point2& from, const Goal& goal, std::span<const Obstacle> walls) {
  using Entry = std::pair<float, Vertex>;
  const auto target = static_cast<Vertex>(labels_.size() - 1);
  const auto start = static_cast<Vertex>(labels_.size());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto relax = [&](Vertex v, Vertex parent, double cost) {
    Label& label = labels_[v];
    if (label.search == search_ && (label.closed || label.cost <= static_cast<float>(cost))) return;
    label = {search_, false, parent, static_cast<float>(cost)};
    const double estimate = goal.place && v != target ? (at(v) - *goal.place).norm() : 0;
    open.emplace(static_cast<float>(cost + estimate), v);
  };
  for_each_link(from, walls, [&](Vertex v, double metres) { relax(v, start, metres); });
  std::vector<std::pair<Vertex, double>> last_links;
  if (goal.place) {
    for_each_link(*goal.place, walls, [&](Vertex v, double metres) { last_links.emplace_back(v, metres); });
    if (last_links.empty()) return {};
  }

  Vertex found = start;
  double best = std::numeric_limits<double>::infinity();
  while (!open.empty()) {
    const Vertex v = open.top().second;
    open.pop();
    Label& here = labels_[v];
    if (here.closed) continue;
    here.closed = true;
    ++effort_;
    const double cost = here.cost;
    if (v == target) {
      found = target;
      break;
    }
    if (!goal.place) {
      if (cost >= best) break;
      if ((marks(v) & (swept | crossing)) == 0) {
        const double value = cost + ((marks(v) & avoided) != 0 ? goal.detour_of_avoided : 0);
        if (value < best) {
          best = value;
          found = v;
        }
      }
    }
    for (const auto& [w, metres] : last_links) {
      if (w == v) relax(target, v, cost + metres);
    }
    for_each_neighbour(v, [&](Vertex w, double metres) {
      relax(w, v, cost + metres * ((marks(w) & crossing) != 0 ? crossing_factor : 1));
    });
  }
  if (found == start) return {};

  Path path;
  for (Vertex v = found; v != start; v = labels_[v].parent) path.push_back(v == target ? *goal.place : at(v));
  path.push_back(from);
  std::ranges::reverse(path);
  return path;
}

Path RouteFinder::straightened(Path path, std::span<const Obstacle> walls) const {
  return shorten(SpaceWithDiscs<Obstacle>{field_, walls}, std::move(path), radius_);
}

Path RouteFinder::route(const Point2& from, const Point2& to, std::span<const Disc> discs) {
  const std::vector<Obstacle> walls = obstacles(discs, from, to);
  for (const Disc& disc : discs) {
    if ((to - disc.centre).norm() < radius_ + disc.radius + standing_gap) return {};
  }
  if (SpaceWithDiscs<Obstacle>{field_, walls}.segment_free(from, to, radius_)) return {from, to};
  begin_search();
  for (const Obstacle& o : walls)
    mark(o.centre, o.centre, std::hypot(o.distance, spacing_ / std::numbers::sqrt2), wall);
  return straightened(search(from, {to}, walls), walls);
}

Path RouteFinder::route_through(const Point2& from, const Point2& to, std::span<const Disc> discs,
                                std::span<const Disc> movable) {
  begin_search();
  const std::vector<Obstacle> walls = obstacles(discs, from, to);
  for (const Obstacle& o : walls)
    mark(o.centre, o.centre, std::hypot(o.distance, spacing_ / std::numbers::sqrt2), wall);
  for (const Obstacle& o : obstacles(movable, from, std::nullopt))
    mark(o.centre, o.centre, o.distance, crossing);
  return search(from, {to}, walls);
}

Path RouteFinder::refuge(const Point2& from, std::span<const Disc> discs, std::span<const Disc> movable,
                         std::span<const Sweep> sweeps, std::span<const Sweep> avoid) {
  begin_search();
  const std::vector<Obstacle> walls = obstacles(discs, from, std::nullopt);
  for (const Obstacle& o : walls)
    mark(o.centre, o.centre, std::hypot(o.distance, spacing_ / std::numbers::sqrt2), wall);
  for (const Obstacle& o : obstacles(movable, from, std::nullopt))
    mark(o.centre, o.centre, o.distance, crossing);
  const auto mark_all = [&](std::span<const Sweep> all, Mark what) {
    for (const Sweep& sweep : all) {
      const double distance = radius_ + sweep.radius * (1 + comfort) + standing_gap;
      for (std::size_t k = 1; k < sweep.path.size(); ++k)
        mark(sweep.path[k - 1], sweep.path[k], distance, what);
    }
  };
  mark_all(sweeps, swept);
  mark_all(avoid, avoided);
  const Path path = search(from, {std::nullopt, avoided_detour * radius_}, walls);
  return movable.empty() ? straightened(path, walls) : path;
}

void RouteFinder::flood(const Point2& from, std::span<const Disc> discs) {
  begin_search();
  std::vector<Obstacle> walls;
  for (const Disc& disc : discs) {
    const double distance = std::min(radius_ + disc.radius + standing_gap, (from - disc.centre).norm());
    walls.push_back({disc.centre, distance});
    mark(disc.centre, disc.centre, std::hypot(distance, spacing_ / std::numbers::sqrt2), wall);
  }
  std::vector<Vertex> open;
  const auto reach = [&](Vertex v, double) {
    if (labels_[v].search == search_) return;
    labels_[v] = {search_, true, 0, 0};
    open.push_back(v);
  };
  for_each_link(from, walls, reach);
  while (!open.empty()) {
    const Vertex v = open.back();
    open.pop_back();
    ++effort_;
    for_each_neighbour(v, reach);
  }
}

bool RouteFinder::flooded(const Point2& place) {
  bool found = false;
  for_each_link(place, {}, [&](Vertex v, double) { found |= labels_[v].search == search_; });
  return found;
}

std::vector<std::size_t> RouteFinder::blockers(const Path& path, std::span<const Disc> discs) const {
  std::vector<std::size_t> result;
  const std::vector<Obstacle> near = obstacles(discs, path.front(), std::nullopt);
  for (std::size_t d = 0; d < discs.size(); ++d) {
    const double touching = radius_ + discs[d].radius + standing_gap;
    const double at_goal = std::max(touching, (path.back() - discs[d].centre).norm());
    const double distance = std::min(near[d].distance, at_goal) - rounding;
    for (std::size_t k = 1; k < path.size(); ++k) {
      if (point_segment_distance(discs[d].centre, path[k - 1], path[k]) >= distance) continue;
      result.push_back(d);
      break;
    }
  }
  return result;
}

}  // namespace coppice
