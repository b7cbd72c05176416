#include "motion/lattice/packed_roadmap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>

#include "motion/lattice/narrow_passages.h"
#include "motion/trajectory/segments.h"
#include "planning/geometry/free_way.h"
#include "planning/geometry/line_of_sight.h"
#include "planning/geometry/neighbour_grid.h"

namespace coppice {

namespace {

constexpr double reach_of_more = 1.8;  // distance to which added vertices are linked in a straight line, in
                                       // distances between packed vertices
constexpr double left_lane = 2;        // cost of a metre there, times that elsewhere
constexpr double detour_for_comfort = 1.5;  // factor of length that a way away from corners is worth
constexpr double rounding = 1e-9;           // metres
constexpr double around_crowd = 16;         // radii within which a cluster may use added vertices
constexpr double stack_reach = 12;          // radii along a passage from its end
constexpr double same_place = 0.02;         // radii within which two points count as the same vertex
constexpr std::size_t most_stacked = 100;   // points per robot

using Edge = AnnotatedRoadmap::Edge;

/// Calls fn(point) for points of a path such that each part of it lies within half of `spacing` of one.
template <class Fn>
void for_each_sample(const Path& path, double spacing, Fn&& fn) {
  for (std::size_t k = 1; k < path.size(); ++k) {
    const Point2 way = path[k] - path[k - 1];
    const double parts = std::ceil(way.norm() / spacing + rounding);
    for (double part = 0.5; part < parts; ++part) fn(Point2(path[k - 1] + way * (part / parts)));
  }
}

/// Whether a point is near an edge: nearer to its path than `distance`. A point that is nearer than that to
/// an end, but does not touch it, counts only if the path comes nearer still.
struct Nearness {
  double touching;
  double distance;

  bool operator()(const Point2& p, const Edge& edge) const {
    const double from_start = (p - edge.path.front()).norm();
    const double from_end = (p - edge.path.back()).norm();
    if (from_start + from_end > edge.length + 2 * distance) return false;
    const double at_ends = std::min(from_start, std::max(touching, from_end));
    return point_path_distance(p, edge.path) < std::min(distance, at_ends) - rounding;
  }
};

/// Appends to `edge.near` the vertices of a grid, numbered from `first` on, that are near the edge.
/// `distance` of `is_near` is at most two thirds of the grid's reach.
void add_near(const NeighbourGrid<2>& grid, double reach, Vertex first, const Nearness& is_near, Edge& edge) {
  for_each_sample(edge.path, reach / 3, [&](const Point2& p) {
    grid.for_each_near(p, [&](NodeId k, const Point2& q) {
      if (is_near(q, edge)) edge.near.push_back(first + k);
    });
  });
}

void sort_near(Edge& edge) {
  std::ranges::sort(edge.near);
  edge.near.erase(std::unique(edge.near.begin(), edge.near.end()), edge.near.end());
}

/// An edge along the path. add(edge) appends the vertices near it.
template <class Add>
Edge edge_along(Vertex to, Path path, Add&& add) {
  const double length = length_of(path);
  Edge edge{.to = to, .length = length, .path = std::move(path), .near = {to}};
  add(edge);
  sort_near(edge);
  return edge;
}

/// Adds an edge from a to b and one back.
template <class Add>
void add_edges(AnnotatedRoadmap& graph, Vertex a, Vertex b, Path path, Add&& add) {
  graph.own_edges(a).push_back(edge_along(b, path, add));
  std::ranges::reverse(path);
  graph.own_edges(b).push_back(edge_along(a, std::move(path), add));
}

}  // namespace

PackedRoadmap::PackedRoadmap(const ClearanceField& field, double radius, double spacing,
                             const std::optional<Point2>& anchor)
    : field_(field),
      radius_(radius),
      touching_(2 * radius + standing_gap),
      apart_(anchor ? touching_ : touching_ + comfort_radii * radius),
      reach_(reach_of_more * apart_),
      lattice_(field, radius, spacing),
      grid_(field.bounds(), reach_),
      points_of_ways_(field.bounds(), reach_) {
  pack(anchor ? from(*anchor) : in_layers());
  grow_cells();
  link(crossings());
  lattice_.forget();
  index_ways();
}

/// The free vertices in layers, those nearest to obstacles first, so that consecutive vertices follow a wall.
/// A large map has a million: so they are counted into layers instead of sorted.
std::vector<Lattice::Vertex> PackedRoadmap::in_layers() {
  const auto for_each_free = [&](auto&& fn) {
    for (Lattice::Vertex v = 0; v < lattice_.size(); ++v) {
      if (lattice_.vertex_free(v))
        fn(v, static_cast<std::size_t>(2 * field_.lower_bound(lattice_.at(v)) / lattice_.spacing()));
    }
  };
  std::vector<std::size_t> next{0};  // by layer: where it begins, then where its next vertex goes
  for_each_free([&](Lattice::Vertex, std::size_t layer) {
    next.resize(std::max(next.size(), layer + 2));
    ++next[layer + 1];
  });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<Lattice::Vertex> order(next.back());
  for_each_free([&](Lattice::Vertex v, std::size_t layer) { order[next[layer]++] = v; });
  return order;
}

/// The free vertices by the length of the way from the anchor, as far as there is one.
std::vector<Lattice::Vertex> PackedRoadmap::from(const Point2& anchor) {
  using Entry = std::pair<double, Lattice::Vertex>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::vector<double> distance(lattice_.size(), std::numeric_limits<double>::infinity());
  const auto reach = [&](Lattice::Vertex v, double metres) {
    if (distance[v] <= metres) return;
    distance[v] = metres;
    open.emplace(metres, v);
  };
  lattice_.for_each_around(anchor, Lattice::usual_reach, [&](Lattice::Vertex v) {
    if (lattice_.vertex_free(v) && way_free(field_, anchor, lattice_.at(v), radius_))
      reach(v, (lattice_.at(v) - anchor).norm());
  });
  std::vector<Lattice::Vertex> order;
  while (!open.empty()) {
    const double least = open.top().first;
    const Lattice::Vertex v = open.top().second;
    open.pop();
    if (least > distance[v]) continue;
    order.push_back(v);
    lattice_.for_each_neighbour(
        v, [](Lattice::Vertex) { return true; },
        [&](Lattice::Vertex w, double metres) { reach(w, least + metres); });
  }
  return order;
}

void PackedRoadmap::pack(std::span<const Lattice::Vertex> order) {
  NeighbourGrid<2> grid(field_.bounds(), apart_);
  for (const Lattice::Vertex v : order) {
    const Point2 p = lattice_.at(v);
    bool taken = false;
    grid.for_each_near(p, [&](NodeId, const Point2& q) {
      const double distance = (p - q).norm();
      // Robots may stand a little closer on two sides of a thin wall.
      taken |= distance < touching_ || (distance < apart_ && field_.segment_free(p, q, 0));
    });
    if (taken) continue;
    grid.insert(p);
    grid_.insert(packed_.at(packed_.add(p, radius_)));
    place_at_.emplace(v, static_cast<Vertex>(size() - 1));
  }
}

/// The cost of a step of `metres` from a vertex.
double PackedRoadmap::cost(Lattice::Vertex v, double metres) const {
  const bool tight = field_.lower_bound(lattice_.at(v)) < (1 + comfort_radii) * radius_;
  return metres * (tight ? detour_for_comfort : 1);
}

/// Dijkstra's search from all roadmap vertices at once.
void PackedRoadmap::grow_cells() {
  using Entry = std::pair<float, Lattice::Vertex>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::vector<float> cost_of(lattice_.size(), std::numeric_limits<float>::infinity());
  towards_.assign(lattice_.size(), nowhere_to);
  for (const auto& [v, place] : place_at_) {
    cost_of[v] = 0;
    towards_[v] = here;
    open.emplace(0.0F, v);
  }
  while (!open.empty()) {
    const auto [least, v] = open.top();
    open.pop();
    if (least > cost_of[v]) continue;
    lattice_.for_each_neighbour(
        v, [](Lattice::Vertex) { return true; },
        [&, v = v, least = least](Lattice::Vertex w, double metres) {
          const float there = least + static_cast<float>(cost(w, metres));
          if (cost_of[w] <= there) return;
          cost_of[w] = there;
          towards_[w] = lattice_.direction(w, v);
          open.emplace(there, w);
        });
  }
}

/// The roadmap vertex in whose Voronoi cell a lattice vertex lies. It must lie in one.
Vertex PackedRoadmap::cell(Lattice::Vertex v) const {
  while (towards_[v] != here) v = lattice_.beside(v, towards_[v]);
  return place_at_.at(v);
}

/// The cells of all lattice vertices; `nowhere` for those in no cell.
std::vector<Vertex> PackedRoadmap::cells() const {
  std::vector<Vertex> cells(lattice_.size(), nowhere);
  for (Lattice::Vertex v = 0; v < lattice_.size(); ++v) {
    if (towards_[v] != nowhere_to) cells[v] = cell(v);
  }
  return cells;
}

/// The cost from a lattice vertex to the roadmap vertex of its cell, with the same rounding as in
/// grow_cells().
float PackedRoadmap::cost_to_its_place(Lattice::Vertex v) const {
  if (towards_[v] == here) return 0;
  const Lattice::Vertex next = lattice_.beside(v, towards_[v]);
  return cost_to_its_place(next) + static_cast<float>(cost(v, lattice_.length(towards_[v])));
}

/// For each two cells that touch, the crossing with the shortest way between their roadmap vertices.
PackedRoadmap::Crossings PackedRoadmap::crossings() {
  const std::vector<Vertex> cell_of = cells();
  Crossings crossings;
  for (Lattice::Vertex v = 0; v < lattice_.size(); ++v) {
    if (cell_of[v] == nowhere) continue;
    lattice_.for_each_neighbour(
        v, [&](Lattice::Vertex w) { return cell_of[w] != nowhere && cell_of[v] < cell_of[w]; },
        [&](Lattice::Vertex w, double metres) {
          const Crossing crossing{cost_to_its_place(v) + metres + cost_to_its_place(w), v, w};
          const auto [known, fresh] = crossings.try_emplace({cell_of[v], cell_of[w]}, crossing);
          if (!fresh && crossing.length < known->second.length) known->second = crossing;
        });
  }
  return crossings;
}

/// Links the roadmap vertices whose cells touch.
void PackedRoadmap::link(const Crossings& crossings) {
  const auto add = [&](Edge& edge) {
    if (is_right_lane(edge.path)) edge.cost_back = left_lane;
    add_near(grid_, reach_, 0, {touching_, apart_}, edge);
  };
  for (const auto& [pair, crossing] : crossings) {
    Path path = way_to_its_place(crossing.a);
    std::ranges::reverse(path);
    const Path rest = way_to_its_place(crossing.b);
    path.insert(path.end(), rest.begin(), rest.end());
    add_edges(packed_, pair.first, pair.second, optimise_line_of_sight(field_, path, radius_), add);
  }
  packed_.shrink_to_fit();
}

/// Whether another robot has room to the left of a way, and none has to its right.
bool PackedRoadmap::is_right_lane(const Path& path) const {
  const Point2 middle = 0.5 * (path.front() + path.back());
  const Point2 way = path.back() - path.front();
  const Point2 left = apart_ * Point2(-way.y(), way.x()).normalized();
  return field_.segment_free(middle, middle + left, radius_) &&
         !field_.segment_free(middle, middle - left, radius_);
}

void PackedRoadmap::index_ways() {
  for (Vertex from = 0; from < size(); ++from) {
    for (const Edge& edge : packed_.edges(from)) {
      if (edge.to < from) continue;
      for_each_sample(edge.path, reach_ / 3, [&](const Point2& p) {
        points_of_ways_.insert(p);
        ways_.emplace_back(from, edge.to);
      });
    }
  }
  ways_.shrink_to_fit();
  points_of_ways_.shrink_to_fit();
}

/// Calls fn(vertex, vertex) for the ends of all packed edges nearer to p than `distance`. It may name an edge
/// more than once, and edges beyond.
template <class Fn>
void PackedRoadmap::for_each_way_near(const Point2& p, double distance, Fn&& fn) const {
  if (distance + reach_ / 6 > reach_) {
    for (const auto& [a, b] : ways_) fn(a, b);
  } else {
    points_of_ways_.for_each_near(p, [&](NodeId k, const Point2&) { fn(ways_[k].first, ways_[k].second); });
  }
}

/// The way within a Voronoi cell from a lattice vertex to the cell's roadmap vertex.
Path PackedRoadmap::way_to_its_place(Lattice::Vertex v) const {
  Path path{lattice_.at(v)};
  while (towards_[v] != here) {
    v = lattice_.beside(v, towards_[v]);
    path.push_back(lattice_.at(v));
  }
  return path;
}

/// The shortest way from p to the roadmap vertex of one of the cells around; empty if there is none.
Path PackedRoadmap::way_to_a_place(const Point2& p, Vertex& place) {
  double least = std::numeric_limits<double>::infinity();
  std::optional<Lattice::Vertex> first;
  lattice_.for_each_around(p, Lattice::usual_reach, [&](Lattice::Vertex v) {
    if (towards_[v] == nowhere_to || !way_free(field_, p, lattice_.at(v), radius_)) return;
    double length = (lattice_.at(v) - p).norm();
    Lattice::Vertex at = v;
    for (Lattice::Vertex next = at; towards_[at] != here; at = next) {
      next = lattice_.beside(at, towards_[at]);
      length += cost(at, (lattice_.at(next) - lattice_.at(at)).norm());
    }
    if (length >= least) return;
    least = length;
    place = place_at_.at(at);
    first = v;
  });
  if (!first) return {};
  Path path = way_to_its_place(*first);
  path.insert(path.begin(), p);
  return optimise_line_of_sight(field_, path, radius_);
}

bool PackedRoadmap::passes(std::span<const Disc> obstacles, const Path& path) const {
  return std::ranges::none_of(obstacles, [&](const Disc& disc) {
    return point_path_distance(disc.centre, path) < radius_ + disc.radius + standing_gap;
  });
}

/// Removes the packed edges that do not pass the obstacles.
void PackedRoadmap::leave_out(std::span<const Disc> obstacles, AnnotatedRoadmap& graph) const {
  for (const Disc& disc : obstacles) {
    const auto leads_into = [&](const Edge& edge) { return !passes({&disc, 1}, edge.path); };
    for_each_way_near(disc.centre, radius_ + disc.radius + standing_gap, [&](Vertex a, Vertex b) {
      for (const Vertex from : {a, b}) {
        if (std::ranges::any_of(graph.edges(from), leads_into))
          std::erase_if(graph.own_edges(from), leads_into);
      }
    });
  }
}

AnnotatedRoadmap PackedRoadmap::with(std::span<const Point2> more, std::span<const Disc> obstacles) {
  AnnotatedRoadmap graph = AnnotatedRoadmap::over(packed_);
  const auto first = static_cast<Vertex>(graph.size());
  const Nearness is_near{touching_, apart_};
  NeighbourGrid<2> grid_of_more(field_.bounds(), reach_);
  for (const Point2& p : more) {
    const Vertex place = graph.add(p, radius_);
    grid_of_more.insert(p);
    for_each_way_near(p, apart_, [&](Vertex a, Vertex b) {
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        const auto edge = std::ranges::find(graph.edges(from), to, &Edge::to);
        if (edge->near.back() == place || !is_near(p, *edge)) continue;
        const auto index = edge - graph.edges(from).begin();
        graph.own_edges(from)[static_cast<std::size_t>(index)].near.push_back(place);
      }
    });
  }
  leave_out(obstacles, graph);

  const auto link_over = [&](Vertex a, Vertex b, Path path) {
    if (!passes(obstacles, path)) return;
    add_edges(graph, a, b, std::move(path), [&](Edge& edge) {
      if (is_right_lane(edge.path)) edge.cost_back = left_lane;
      add_near(grid_, reach_, 0, is_near, edge);
      add_near(grid_of_more, reach_, first, is_near, edge);
    });
  };
  for (Vertex from = first; from < graph.size(); ++from) {
    const Point2 p = graph.at(from);
    const auto link_straight = [&](Vertex to, const Point2& q) {
      if ((p - q).norm() < reach_ && p != q && way_free(field_, p, q, radius_)) link_over(from, to, {p, q});
    };
    grid_.for_each_near(p, [&](NodeId k, const Point2& q) { link_straight(k, q); });
    grid_of_more.for_each_near(p, [&](NodeId k, const Point2& q) {
      if (first + k > from) link_straight(first + k, q);
    });
    const auto link_unless_known = [&](Vertex to, Path path) {
      const bool known = std::ranges::find(graph.edges(from), to, &Edge::to) != graph.edges(from).end();
      if (!known) link_over(from, to, std::move(path));
    };
    Vertex nearest = 0;
    const Path way = way_to_a_place(p, nearest);
    if (way.size() < 2) continue;
    link_unless_known(nearest, way);
    for (const Edge& edge : packed_.edges(nearest)) {  // links around corners
      Path further = way;
      further.insert(further.end(), edge.path.begin() + 1, edge.path.end());
      link_unless_known(edge.to, optimise_line_of_sight(field_, further, radius_));
    }
  }
  graph.shrink_to_fit();
  return graph;
}

std::vector<Point2> PackedRoadmap::ends(std::span<const Point2> centres) const {
  NarrowPassages passages(field_, radius_, lattice_.spacing());
  std::vector<Point2> result;
  for (const Point2& centre : centres) {
    for (const Lattice::Vertex end : passages.ends(centre, around_crowd * radius_))
      result.push_back(lattice_.at(end));
  }
  const auto to_nearest_centre = [&](const Point2& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Point2& centre : centres) least = std::min(least, (p - centre).norm());
    return least;
  };
  std::ranges::stable_sort(result, std::less{}, to_nearest_centre);
  return result;
}

std::vector<Point2> PackedRoadmap::stacked(std::span<const Point2> centres) const {
  NarrowPassages passages(field_, radius_, lattice_.spacing());
  NeighbourGrid<2> known(field_.bounds(), touching_);
  for (Vertex place = 0; place < size(); ++place) known.insert(packed_.at(place));
  const auto is_new = [&](const Point2& p) {
    bool fresh = true;
    known.for_each_near(p, [&](NodeId, const Point2& q) { fresh &= (p - q).norm() > same_place * radius_; });
    return fresh;
  };
  std::vector<Point2> result;
  for (const Point2& centre : centres) {
    for (const Lattice::Vertex end : passages.ends(centre, around_crowd * radius_)) {
      for (const Point2& p : passages.stack_from(end, touching_, stack_reach * radius_)) {
        if (!is_new(p) || result.size() >= most_stacked * centres.size()) continue;
        known.insert(p);
        result.push_back(p);
      }
    }
  }
  return result;
}

/// Edges keep the robots of two sizes from touching. Within a size, packed vertices also leave some room.
AnnotatedRoadmap united(std::span<const AnnotatedRoadmap> parts, const Box<2>& bounds) {
  AnnotatedRoadmap all;
  std::vector<Vertex> first;  // by part
  for (const AnnotatedRoadmap& part : parts) {
    first.push_back(static_cast<Vertex>(all.size()));
    for (Vertex v = 0; v < part.size(); ++v) {
      std::vector<Edge>& edges = all.own_edges(all.add(part.at(v), part.radius(v)));
      edges = part.edges(v);
      for (Edge& edge : edges) {
        edge.to += first.back();
        for (Vertex& near : edge.near) near += first.back();
      }
    }
  }
  for (std::size_t k = 0; k < parts.size(); ++k) {
    for (std::size_t other = 0; other < parts.size(); ++other) {
      if (other == k) continue;
      const double touching = parts[k].radius(0) + parts[other].radius(0) + standing_gap;
      NeighbourGrid<2> grid(bounds, 1.5 * touching);
      for (Vertex v = 0; v < parts[other].size(); ++v) grid.insert(parts[other].at(v));
      for (Vertex v = 0; v < parts[k].size(); ++v) {
        for (Edge& edge : all.own_edges(first[k] + v))
          add_near(grid, 1.5 * touching, first[other], {touching, touching}, edge);
      }
    }
  }
  for (Vertex v = 0; v < all.size(); ++v) {
    for (Edge& edge : all.own_edges(v)) sort_near(edge);
  }
  return all;
}

/// As if all of the map were free.
bool MapRoadmaps::can_pack(double radius) const {
  const Point2 extent = field_.bounds().upper - field_.bounds().lower;
  const double apart = std::max((2 + comfort_radii) * radius, field_.frame().resolution / 2);
  return extent.prod() <= most_places * apart * apart;
}

PackedRoadmap& MapRoadmaps::packed(double radius, double spacing) {
  return packed_.try_emplace({radius, spacing}, field_, radius, spacing).first->second;
}

}  // namespace coppice
