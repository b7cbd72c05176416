#include "motion/lattice/route_finder.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "motion/trajectory/segments.h"
#include "planning/geometry/free_way.h"
#include "planning/geometry/path_shortening.h"

namespace coppice {

namespace {

// Share of the own radius that is kept clear beyond the radii: how far a robot that follows its route may
// stray.
constexpr double comfort = 0.1;
constexpr double crossing_factor = 8;  // factor of length where a route leads through a disc that may move
// Radii by which a refuge may be further away if it lies in no robot's way.
constexpr double avoided_detour = 30;
constexpr double rounding = 1e-9;  // metres
// Limit of a lattice that is to find what a coarser one did not: 40 MB.
constexpr double most_vertices = 1.5e6;
constexpr int most_reach = 16;  // columns and rows on each side to which an end of a route is linked

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
    : field_(field),
      radius_(radius),
      lattice_(field, radius, spacing),
      labels_(lattice_.size() + 1),  // the last label is the goal's
      marked_(lattice_.size(), 0),
      mark_(lattice_.size(), 0) {}

void RouteFinder::begin_search() {
  if (++search_ != 0) return;
  // The counter has wrapped around: no label may seem to belong to this search.
  std::ranges::fill(marked_, 0);
  std::ranges::fill(labels_, Label{});
  search_ = 1;
}

/// Marks the vertices within `distance` of the segment from a to b.
void RouteFinder::mark(const Point2& a, const Point2& b, double distance, Mark what) {
  lattice_.for_each_near(a, b, distance, [&](Vertex v) {
    mark_[v] = static_cast<std::uint8_t>(marks(v) | what);
    marked_[v] = search_;
    ++effort_;
  });
}

/// Marks vertices so far around that no edge between unmarked vertices comes closer than the distance. The
/// longest edge is a diagonal; half of it is the spacing over the root of two.
void RouteFinder::mark_walls(std::span<const Obstacle> walls) {
  for (const Obstacle& o : walls)
    mark(o.centre, o.centre, std::hypot(o.distance, spacing() / std::numbers::sqrt2), wall);
}

std::vector<RouteFinder::Obstacle> RouteFinder::obstacles(std::span<const Disc> discs, const Point2& from,
                                                          const std::optional<Point2>& to) const {
  // If an end of the route is closer to a disc than is comfortable, the route may use up half of the
  // remaining gap.
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

/// Calls fn(vertex, metres) for the vertices around p that see p in a straight line. If none of the nearest
/// does, vertices further away are tried: a robot in a clinch may have only a narrow way out between two of
/// the nearest.
template <class Fn>
void RouteFinder::for_each_link(const Point2& p, std::span<const Obstacle> obstacles, Fn&& fn) {
  const SpaceWithDiscs<Obstacle> space{field_, obstacles};
  bool linked = false;
  for (int reach = Lattice::usual_reach; !linked && reach <= most_reach; reach *= 2) {
    lattice_.for_each_around(p, reach, [&](Vertex v) {
      if (!lattice_.vertex_free(v) || !passable(v) || !space.segment_free(p, lattice_.at(v), radius_)) return;
      linked = true;
      fn(v, (lattice_.at(v) - p).norm());
    });
  }
}

/// Calls fn(vertex, metres) for the neighbours to which a free edge leads.
template <class Fn>
void RouteFinder::for_each_neighbour(Vertex v, Fn&& fn) {
  lattice_.for_each_neighbour(
      v, [&](Vertex w) { return passable(w); }, fn);
}

/// A* to the goal's position, or Dijkstra's search for the nearest position that no mark forbids.
Path RouteFinder::search(const Point2& from, const Goal& goal, std::span<const Obstacle> walls) {
  using Entry = std::pair<float, Vertex>;
  const auto target = static_cast<Vertex>(labels_.size() - 1);
  const auto start = static_cast<Vertex>(labels_.size());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto relax = [&](Vertex v, Vertex parent, double cost) {
    Label& label = labels_[v];
    if (label.search == search_ && (label.closed || label.cost <= static_cast<float>(cost))) return;
    label = {search_, false, parent, static_cast<float>(cost)};
    const double estimate = goal.place && v != target ? (lattice_.at(v) - *goal.place).norm() : 0;
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
        if (value < best && (goal.wanted == nullptr || (*goal.wanted)(lattice_.at(v)))) {
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
  for (Vertex v = found; v != start; v = labels_[v].parent)
    path.push_back(v == target ? *goal.place : lattice_.at(v));
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
  mark_walls(walls);
  return straightened(search(from, {to}, walls), walls);
}

Path RouteFinder::route_through(const Point2& from, const Point2& to, std::span<const Disc> discs,
                                std::span<const Disc> movable) {
  begin_search();
  const std::vector<Obstacle> walls = obstacles(discs, from, to);
  mark_walls(walls);
  for (const Obstacle& o : obstacles(movable, from, std::nullopt))
    mark(o.centre, o.centre, o.distance, crossing);
  return search(from, {to}, walls);
}

Path RouteFinder::refuge(const Point2& from, std::span<const Disc> discs, std::span<const Disc> movable,
                         std::span<const Sweep> sweeps, std::span<const Sweep> avoid) {
  begin_search();
  const std::vector<Obstacle> walls = obstacles(discs, from, std::nullopt);
  mark_walls(walls);
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

Path RouteFinder::to_nearest(const Point2& from, std::span<const Disc> discs,
                             const std::function<bool(const Point2&)>& wanted) {
  begin_search();
  const std::vector<Obstacle> walls = obstacles(discs, from, std::nullopt);
  mark_walls(walls);
  return straightened(search(from, {.wanted = &wanted}, walls), walls);
}

std::size_t RouteFinder::flood(const Point2& from, std::span<const Disc> discs) {
  begin_search();
  std::vector<Obstacle> walls;
  for (const Disc& disc : discs) {
    const double distance = std::min(radius_ + disc.radius + standing_gap, (from - disc.centre).norm());
    walls.push_back({disc.centre, distance});
  }
  mark_walls(walls);
  std::vector<Vertex> open;
  const auto reach = [&](Vertex v, double) {
    if (labels_[v].search == search_) return;
    labels_[v] = {search_, true, 0, 0};
    open.push_back(v);
  };
  for_each_link(from, walls, reach);
  std::size_t reached = 0;
  for (; !open.empty(); ++reached) {
    const Vertex v = open.back();
    open.pop_back();
    for_each_neighbour(v, reach);
  }
  effort_ += reached;
  return reached;
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

SpacedRoute coarsest_route(const ClearanceField& field, double radius, const Point2& from, const Point2& to,
                           std::span<const Disc> discs, double share) {
  while (true) {
    RouteFinder finder(field, radius, share * usual_spacing(radius));
    Path path = finder.route(from, to, discs);
    const Point2 extent = field.bounds().upper - field.bounds().lower;
    const double next_size = 4 * extent.x() * extent.y() / (finder.spacing() * finder.spacing());
    const bool finest = finder.spacing() <= field.frame().resolution / 2 || next_size > most_vertices;
    if (!path.empty() || finest) return {std::move(path), share};
    share /= 2;
  }
}

}  // namespace coppice
