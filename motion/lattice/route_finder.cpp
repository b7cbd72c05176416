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
      wall_(lattice_.size(), 0) {}

void RouteFinder::begin_search() {
  if (++search_ != 0) return;
  // The counter has wrapped around: no label may seem to belong to this search.
  std::ranges::fill(wall_, 0);
  std::ranges::fill(labels_, Label{});
  search_ = 1;
}

/// Marks vertices so far around that no edge between unmarked vertices comes closer than the distance. The
/// longest edge is a diagonal; half of it is the spacing over the root of two.
void RouteFinder::mark_walls(std::span<const Obstacle> walls) {
  for (const Obstacle& o : walls)
    lattice_.for_each_near(o.centre, o.centre, std::hypot(o.distance, spacing() / std::numbers::sqrt2),
                           [&](Vertex v) { wall_[v] = search_; });
}

std::vector<RouteFinder::Obstacle> RouteFinder::obstacles(std::span<const Disc> discs, const Point2& from,
                                                          const Point2& to) const {
  // If an end of the route is closer to a disc than is comfortable, the route may use up half of the
  // remaining gap.
  const auto at_end = [&](const Point2& end, const Disc& disc, double touching) {
    const double gap = (end - disc.centre).norm() - touching;
    return touching + (gap > 0 ? gap / 2 : gap);
  };
  std::vector<Obstacle> result;
  for (const Disc& disc : discs) {
    const double touching = radius_ + disc.radius + standing_gap;
    double distance = touching + comfort_radii * radius_;
    if ((from - disc.centre).norm() < distance) distance = at_end(from, disc, touching);
    if ((to - disc.centre).norm() < distance) distance = std::min(distance, at_end(to, disc, touching));
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

/// A*. Empty if there is no way.
Path RouteFinder::search(const Point2& from, const Point2& to, std::span<const Obstacle> walls) {
  using Entry = std::pair<float, Vertex>;
  const auto target = static_cast<Vertex>(labels_.size() - 1);
  const auto start = static_cast<Vertex>(labels_.size());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto relax = [&](Vertex v, Vertex parent, double cost) {
    Label& label = labels_[v];
    if (label.search == search_ && (label.closed || label.cost <= static_cast<float>(cost))) return;
    label = {search_, false, parent, static_cast<float>(cost)};
    const double estimate = v != target ? (lattice_.at(v) - to).norm() : 0;
    open.emplace(static_cast<float>(cost + estimate), v);
  };
  for_each_link(from, walls, [&](Vertex v, double metres) { relax(v, start, metres); });
  std::vector<std::pair<Vertex, double>> last_links;
  for_each_link(to, walls, [&](Vertex v, double metres) { last_links.emplace_back(v, metres); });
  if (last_links.empty()) return {};
  while (!open.empty() && open.top().second != target) {
    const Vertex v = open.top().second;
    open.pop();
    Label& here = labels_[v];
    if (std::exchange(here.closed, true)) continue;
    const double cost = here.cost;
    for (const auto& [w, metres] : last_links) {
      if (w == v) relax(target, v, cost + metres);
    }
    lattice_.for_each_neighbour(
        v, [&](Vertex w) { return passable(w); },
        [&](Vertex w, double metres) { relax(w, v, cost + metres); });
  }
  if (open.empty()) return {};

  Path path{to};
  for (Vertex v = labels_[target].parent; v != start; v = labels_[v].parent) path.push_back(lattice_.at(v));
  path.push_back(from);
  std::ranges::reverse(path);
  return path;
}

Path RouteFinder::route(const Point2& from, const Point2& to, std::span<const Disc> discs) {
  const std::vector<Obstacle> walls = obstacles(discs, from, to);
  for (const Disc& disc : discs) {
    if ((to - disc.centre).norm() < radius_ + disc.radius + standing_gap) return {};
  }
  if (SpaceWithDiscs<Obstacle>{field_, walls}.segment_free(from, to, radius_)) return {from, to};
  begin_search();
  mark_walls(walls);
  return shorten(SpaceWithDiscs<Obstacle>{field_, walls}, search(from, to, walls), radius_);
}

Path coarsest_route(const ClearanceField& field, double radius, const Point2& from, const Point2& to,
                    std::span<const Disc> discs) {
  for (double spacing = usual_spacing(radius);; spacing /= 2) {
    RouteFinder finder(field, radius, spacing);
    Path path = finder.route(from, to, discs);
    const Point2 extent = field.bounds().upper - field.bounds().lower;
    const double next_size = 4 * extent.x() * extent.y() / (finder.spacing() * finder.spacing());
    const bool finest = finder.spacing() <= field.frame().resolution / 2 || next_size > most_vertices;
    if (!path.empty() || finest) return path;
  }
}

}  // namespace coppice
