#include "motion/places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <utility>

#include "motion/free_way.h"
#include "planning/line_of_sight.h"
#include "planning/neighbour_grid.h"

namespace coppice {

namespace {

constexpr double place_spacing = 0.2;  // radii between points of the lattice that places lie on
constexpr double comfort = 0.1;        // radii between robots on packed places, beyond touching
constexpr double reach_of_more = 1.8;  // of what other places are linked to in a straight line, likewise in
                                       // distances between packed places
constexpr double detour_for_comfort = 1.5;  // that a way round a corner is worth that does not touch it
constexpr double rounding = 1e-9;           // metres

using Edges = std::vector<std::vector<PlaceGraph::Edge>>;

/// An edge there and one back.
void link(Edges& edges, Place a, Place b, Path path) {
  const double length = length_of(path);
  edges[a].push_back({.to = b, .length = length, .path = path});
  std::ranges::reverse(path);
  edges[b].push_back({.to = a, .length = length, .path = std::move(path)});
}

/// Finds places near a point, and those near an edge.
class PlaceGrid {
 public:
  PlaceGrid(const ClearanceField& field, std::span<const Point2> places, double touching, double reach)
      : places_(places), touching_(touching), reach_(reach), grid_(field.bounds(), reach) {
    for (const Point2& p : places) grid_.insert(p);
  }

  /// `distance` at most the grid's reach.
  template <class Fn>
  void for_each_within(const Point2& p, double distance, Fn&& fn) const {
    grid_.for_each_near(p, [&](NodeId k, const Point2& q) {
      if ((p - q).norm() < distance) fn(k);
    });
  }

  /// The places nearer to an edge's path than `distance`, at most two thirds of the reach. Where one
  /// of its ends is nearer, and may be so: those that the path comes nearer to still.
  std::vector<Place> near(Place from, const PlaceGraph::Edge& edge, double distance) const {
    std::vector<Place> found{edge.to};
    const auto check = [&](Place k) {
      if (is_near(k, from, edge, distance)) found.push_back(k);
    };
    for (std::size_t k = 1; k < edge.path.size(); ++k) {
      const Point2 way = edge.path[k] - edge.path[k - 1];
      const double parts = std::ceil(way.norm() / (reach_ / 3) + rounding);
      for (double part = 0.5; part < parts; ++part)
        grid_.for_each_near(edge.path[k - 1] + way * (part / parts),
                            [&](NodeId n, const Point2&) { check(n); });
    }
    std::ranges::sort(found);
    const auto [first, last] = std::ranges::unique(found);
    found.erase(first, last);
    return found;
  }

  /// Whether that holds for place k, which is not `edge.to`.
  bool is_near(Place k, Place from, const PlaceGraph::Edge& edge, double distance) const {
    if (k == from || k == edge.to) return false;
    const double from_start = (places_[k] - places_[from]).norm();
    const double from_end = (places_[k] - places_[edge.to]).norm();
    if (from_start + from_end > edge.length + 2 * distance) return false;
    const double at_ends = std::min(from_start, std::max(touching_, from_end));
    return point_path_distance(places_[k], edge.path) < std::min(distance, at_ends) - rounding;
  }

 private:
  std::span<const Point2> places_;
  double touching_;
  double reach_;
  NeighbourGrid<2> grid_;
};

}  // namespace

std::vector<Place> parts_of(const PlaceGraph& graph) {
  constexpr Place unseen = ~Place{0};
  std::vector<Place> parts(graph.places.size(), unseen);
  for (Place first = 0; first < graph.places.size(); ++first) {
    if (parts[first] != unseen) continue;
    std::vector<Place> open{first};
    parts[first] = first;
    while (!open.empty()) {
      const Place place = open.back();
      open.pop_back();
      for (const PlaceGraph::Edge& edge : graph.edges[place]) {
        if (parts[edge.to] != unseen) continue;
        parts[edge.to] = first;
        open.push_back(edge.to);
      }
    }
  }
  return parts;
}

PackedPlaces::PackedPlaces(const ClearanceField& field, double radius, double spacing)
    : field_(field),
      radius_(radius),
      touching_(2 * radius + standing_gap),
      apart_(touching_ + comfort * radius),
      lattice_(field, radius, spacing) {
  pack();
  grow_cells();
  link_cells();
}

/// Those nearest to obstacles first; in layers, so that along a wall one follows the other.
void PackedPlaces::pack() {
  std::vector<std::pair<int, Lattice::Vertex>> order;
  for (Lattice::Vertex v = 0; v < lattice_.size(); ++v) {
    if (!lattice_.vertex_free(v)) continue;
    order.emplace_back(static_cast<int>(2 * field_.lower_bound(lattice_.at(v)) / lattice_.spacing()), v);
  }
  std::ranges::sort(order);
  NeighbourGrid<2> grid(field_.bounds(), apart_);
  for (const auto& [layer, v] : order) {
    const Point2 p = lattice_.at(v);
    bool taken = false;
    grid.for_each_near(p, [&](NodeId, const Point2& q) {
      const double distance = (p - q).norm();
      // Behind a thin wall somebody may stand a little closer.
      taken |= distance < touching_ || (distance < apart_ && field_.segment_free(p, q, 0));
    });
    if (taken) continue;
    grid.insert(p);
    places_.push_back(p);
    vertices_.push_back(v);
  }
}

/// Dijkstra's search from all places at once.
void PackedPlaces::grow_cells() {
  using Entry = std::pair<float, Lattice::Vertex>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cells_.assign(lattice_.size(), {});
  for (Place k = 0; k < places_.size(); ++k) {
    cells_[vertices_[k]] = {k, 0, vertices_[k]};
    open.emplace(0.0F, vertices_[k]);
  }
  while (!open.empty()) {
    const auto [cost, v] = open.top();
    open.pop();
    if (cost > cells_[v].cost) continue;
    lattice_.for_each_neighbour(
        v, [](Lattice::Vertex) { return true; },
        [&](Lattice::Vertex w, double metres) {
          const bool tight = field_.lower_bound(lattice_.at(w)) < (1 + comfort) * radius_;
          const float there = cost + static_cast<float>(metres * (tight ? detour_for_comfort : 1));
          if (cells_[w].place != nowhere && cells_[w].cost <= there) return;
          cells_[w] = {cells_[v].place, there, v};
          open.emplace(there, w);
        });
  }
}

/// Links the places whose cells touch, where they touch nearest to both.
void PackedPlaces::link_cells() {
  struct Crossing {
    double length;
    Lattice::Vertex a;
    Lattice::Vertex b;
  };
  std::map<std::pair<Place, Place>, Crossing> crossings;
  for (Lattice::Vertex v = 0; v < lattice_.size(); ++v) {
    if (cells_[v].place == nowhere) continue;
    lattice_.for_each_neighbour(
        v, [&](Lattice::Vertex w) { return cells_[w].place != nowhere && cells_[v].place < cells_[w].place; },
        [&](Lattice::Vertex w, double metres) {
          const Crossing crossing{cells_[v].cost + metres + cells_[w].cost, v, w};
          const auto [known, fresh] = crossings.try_emplace({cells_[v].place, cells_[w].place}, crossing);
          if (!fresh && crossing.length < known->second.length) known->second = crossing;
        });
  }
  edges_.assign(places_.size(), {});
  for (const auto& [pair, crossing] : crossings) {
    Path path = way_to_its_place(crossing.a);
    std::ranges::reverse(path);
    const Path rest = way_to_its_place(crossing.b);
    path.insert(path.end(), rest.begin(), rest.end());
    link(edges_, pair.first, pair.second, optimise_line_of_sight(field_, path, radius_));
  }
  const PlaceGrid grid(field_, places_, touching_, reach_of_more * apart_);
  for (Place from = 0; from < places_.size(); ++from) {
    for (PlaceGraph::Edge& edge : edges_[from]) edge.near = grid.near(from, edge, apart_);
  }
}

/// The way within a Voronoi cell from one of its vertices to its place.
Path PackedPlaces::way_to_its_place(Lattice::Vertex v) const {
  Path path{lattice_.at(v)};
  for (; cells_[v].next != v; v = cells_[v].next) path.push_back(lattice_.at(cells_[v].next));
  return path;
}

/// The shortest way from anywhere to the place of one of the cells around; empty if there is none.
Path PackedPlaces::way_to_a_place(const Point2& p, Place& place) {
  double least = std::numeric_limits<double>::infinity();
  Path path;
  lattice_.for_each_around(p, [&](Lattice::Vertex v) {
    if (cells_[v].place == nowhere || !way_free(field_, p, lattice_.at(v), radius_)) return;
    const double length = cells_[v].cost + (lattice_.at(v) - p).norm();
    if (length >= least) return;
    least = length;
    place = cells_[v].place;
    path = way_to_its_place(v);
  });
  if (path.empty()) return path;
  path.insert(path.begin(), p);
  return optimise_line_of_sight(field_, path, radius_);
}

PlaceGraph PackedPlaces::with(std::span<const Point2> more, std::span<const Disc> obstacles) {
  PlaceGraph graph{{more.begin(), more.end()}, std::vector<std::vector<PlaceGraph::Edge>>(more.size())};
  const auto first_packed = static_cast<Place>(more.size());
  graph.places.insert(graph.places.end(), places_.begin(), places_.end());
  for (const std::vector<PlaceGraph::Edge>& edges : edges_) {
    std::vector<PlaceGraph::Edge>& copies = graph.edges.emplace_back(edges);
    for (PlaceGraph::Edge& edge : copies) {
      edge.to += first_packed;
      for (Place& near : edge.near) near += first_packed;
    }
  }

  const PlaceGrid grid(field_, graph.places, touching_, reach_of_more * apart_);
  for (Place from = 0; from < first_packed; ++from) {
    const Point2& p = graph.places[from];
    grid.for_each_within(p, reach_of_more * apart_, [&](Place to) {
      const Point2& q = graph.places[to];
      const bool once = to >= first_packed || to > from;
      if (once && p != q && way_free(field_, p, q, radius_)) link(graph.edges, from, to, {p, q});
    });
    Place to = 0;
    Path path = way_to_a_place(p, to);
    to += first_packed;
    const bool known =
        std::ranges::find(graph.edges[from], to, &PlaceGraph::Edge::to) != graph.edges[from].end();
    if (path.size() > 1 && !known) link(graph.edges, from, to, std::move(path));
  }

  for (Place from = 0; from < graph.places.size(); ++from) {
    std::vector<PlaceGraph::Edge>& edges = graph.edges[from];
    std::erase_if(edges, [&](const PlaceGraph::Edge& edge) {
      return std::ranges::any_of(obstacles, [&](const Disc& disc) {
        return point_path_distance(disc.centre, edge.path) < radius_ + disc.radius + standing_gap;
      });
    });
    for (PlaceGraph::Edge& edge : edges) {
      if (edge.near.empty()) {
        edge.near = grid.near(from, edge, apart_);
      } else {  // a packed one knows the packed places
        for (Place k = first_packed; k-- > 0;) {
          if (grid.is_near(k, from, edge, apart_)) edge.near.insert(edge.near.begin(), k);
        }
      }
    }
  }
  return graph;
}

PackedPlaces& PlacesOfMap::packed(double radius) {
  return by_radius_.try_emplace(radius, field_, radius, place_spacing * radius).first->second;
}

}  // namespace coppice
