// Places where robots can stand, and how one gets from place to place past the others: what a crowd is
// sorted out on (lacam.h).
//
// A graph for one crowd differs little from that of the whole map. So it stands on that: of places that do
// not concern the crowd it has a position and a pointer.
//
// Metres in the map frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "planning/geometry.h"

namespace coppice {

using Vertex = std::uint32_t;

class AnnotatedRoadmap {
 public:
  struct Edge {
    Vertex to = 0;
    double length = 0;
    Path path{};
    std::vector<Vertex>
        near{};  ///< where somebody who stands is touched by a robot on the way; `to` among them; ascending
  };

  AnnotatedRoadmap() = default;
  AnnotatedRoadmap(AnnotatedRoadmap&&) = default;
  AnnotatedRoadmap& operator=(AnnotatedRoadmap&&) = default;
  AnnotatedRoadmap(const AnnotatedRoadmap&) = delete;  // it points to edges of its own
  AnnotatedRoadmap& operator=(const AnnotatedRoadmap&) = delete;
  ~AnnotatedRoadmap() = default;

  /// The same as `ground`, which outlives it and stays as it is.
  static AnnotatedRoadmap over(const AnnotatedRoadmap& ground) {
    AnnotatedRoadmap graph;
    graph.places_ = ground.places_;
    graph.edges_ = ground.edges_;
    return graph;
  }

  /// Places are numbered 0, 1, 2, ... as they are added.
  Vertex add(const Point2& p) {
    const auto place = static_cast<Vertex>(places_.size());
    places_.push_back(p);
    edges_.push_back(&own_[place]);
    return place;
  }

  std::size_t size() const { return places_.size(); }
  const Point2& at(Vertex place) const { return places_[place]; }
  const std::vector<Edge>& edges(Vertex from) const { return *edges_[from]; }

  /// To be changed.
  std::vector<Edge>& own_edges(Vertex from) {
    const auto [own, fresh] = own_.try_emplace(from);
    if (fresh) own->second = *edges_[from];
    edges_[from] = &own->second;
    return own->second;
  }

  /// It is kept for long, or beside much else: takes no more room than it needs.
  void shrink_to_fit() {
    for (auto& [place, edges] : own_) {
      edges.shrink_to_fit();
      for (Edge& edge : edges) edge.near.shrink_to_fit();
    }
    places_.shrink_to_fit();
    edges_.shrink_to_fit();
  }

 private:
  std::vector<Point2> places_;
  std::vector<const std::vector<Edge>*> edges_;        ///< by the place that they lead from
  std::unordered_map<Vertex, std::vector<Edge>> own_;  ///< likewise: those that are not the ground's
};

}  // namespace coppice
