// The roadmap on which a joint planner moves the robots of a cluster (lacam.h): vertices where robots can
// stand, and for each edge the vertices at which a standing robot would be touched.
//
// The roadmap of a cluster differs little from that of the whole map. So it refers to the map's roadmap, and
// stores edges of its own only for vertices that differ; of the others it holds a position and a pointer.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "coppice/planning/geometry.h"
#include "motion/trajectory/segments.h"

namespace coppice {

using Vertex = std::uint32_t;

class AnnotatedRoadmap {
 public:
  struct Edge {
    Vertex to = 0;
    double length = 0;
    Path path{};
    std::vector<Vertex> near{};  ///< vertices at which a standing robot is touched by a robot on this edge;
                                 ///< includes `to`; ascending
    double cost_back = 1;        ///< of a metre on the way back: more in the left one of two lanes
  };

  AnnotatedRoadmap() = default;
  AnnotatedRoadmap(AnnotatedRoadmap&&) = default;
  AnnotatedRoadmap& operator=(AnnotatedRoadmap&&) = default;
  AnnotatedRoadmap(const AnnotatedRoadmap&) = delete;  // it points to its own edges
  AnnotatedRoadmap& operator=(const AnnotatedRoadmap&) = delete;
  ~AnnotatedRoadmap() = default;

  /// Makes a copy that shares the edges of `base`. `base` must outlive it and must not change.
  static AnnotatedRoadmap over(const AnnotatedRoadmap& base) {
    AnnotatedRoadmap graph;
    graph.places_ = base.places_;
    graph.radii_ = base.radii_;
    graph.edges_ = base.edges_;
    return graph;
  }

  /// Adds a vertex for robots of `radius`. Vertices are numbered 0, 1, 2, ... in the order of their addition.
  Vertex add(const Point2& p, double radius = 0) {
    const auto place = static_cast<Vertex>(places_.size());
    places_.push_back(p);
    radii_.push_back(radius);
    edges_.push_back(&own_[place]);
    return place;
  }

  std::size_t size() const { return places_.size(); }
  const Point2& at(Vertex place) const { return places_[place]; }
  double radius(Vertex place) const { return radii_[place]; }
  const std::vector<Edge>& edges(Vertex from) const { return *edges_[from]; }
  /// Whether robots that stand on two vertices are too near to each other.
  bool touch(Vertex a, Vertex b) const {
    return (places_[a] - places_[b]).norm() < radii_[a] + radii_[b] + standing_gap;
  }

  /// The edges of a vertex, for changing them. They are copied if they were shared.
  std::vector<Edge>& own_edges(Vertex from) {
    const auto [own, fresh] = own_.try_emplace(from);
    if (fresh) own->second = *edges_[from];
    edges_[from] = &own->second;
    return own->second;
  }

  /// Frees spare memory of a roadmap that is kept for long.
  void shrink_to_fit() {
    for (auto& [place, edges] : own_) {
      edges.shrink_to_fit();
      for (Edge& edge : edges) edge.near.shrink_to_fit();
    }
    places_.shrink_to_fit();
    radii_.shrink_to_fit();
    edges_.shrink_to_fit();
  }

 private:
  std::vector<Point2> places_;
  std::vector<double> radii_;                    ///< by vertex
  std::vector<const std::vector<Edge>*> edges_;  ///< by the vertex that they lead from
  /// By the vertex that they lead from: edges that are not shared.
  std::unordered_map<Vertex, std::vector<Edge>> own_;
};

}  // namespace coppice
