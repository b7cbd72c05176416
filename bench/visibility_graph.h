// Shortest paths of a disc, at any angle, on a visibility graph.
//
// Lozano-Pérez, Wesley, "An Algorithm for Planning Collision-Free Paths among Polyhedral Obstacles", 1979. A
// disc goes round a convex corner of an obstacle on an arc. Three points around each such arc are the
// vertices, so a path is at most 2.4 % of its arcs longer than the shortest one. Only taut edges count, which
// touch the arcs at both ends (Oh, Leong, "Edge N-Level Sparse Visibility Graphs", 2017). The edges of a
// vertex are computed when a search first comes to it, and kept for later searches.
//
// Metres.
#pragma once

#include <optional>
#include <vector>

#include "coppice/planning/clearance_field.h"

namespace coppice {

class VisibilityGraph {
 public:
  /// Both must outlive it.
  VisibilityGraph(const OccupancyMap& map, const ClearanceField& field) : map_(map), field_(field) {}

  /// The shortest path from start to goal; empty if there is none. Another radius begins a new graph.
  Path path(const Point2& start, const Point2& goal, double radius);
  std::size_t expanded() const { return expanded_; }  ///< vertices expanded in all searches

 private:
  using Number = std::uint32_t;
  struct Vertex {
    Point2 place;
    Point2 before;  ///< direction along the obstacle's boundary, one way
    Point2 after;   ///< the other way
  };
  struct Edge {
    Number to;
    double length;
  };

  void add_vertices(double radius);
  void add_corner(const Point2& corner, const Point2& outwards, double radius);
  bool sees(const Point2& p, const Vertex& v) const;
  const std::vector<Edge>& edges(Number v);

  const OccupancyMap& map_;
  const ClearanceField& field_;
  double radius_ = 0;
  std::vector<Vertex> vertices_{};
  std::vector<std::optional<std::vector<Edge>>> edges_{};  ///< by vertex, once they are known
  std::size_t expanded_ = 0;
};

}  // namespace coppice
