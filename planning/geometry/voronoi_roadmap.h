// Finds the way of a disc, or proves that there is none. A sampling planner cannot do this where a passage is
// as wide as the disc, or closed.
//
// The retraction method (O'Dunlaing and Yap, "A Retraction Method for Planning the Motion of a Disc", 1985):
// a disc can go from start to goal if and only if it can move straight away from the nearest obstacle onto
// the Voronoi diagram of the obstacles' edges, then along the diagram, and the same from the goal. So
// passages as wide as the disc are found as reliably as wide ones. The diagram is Boost.Polygon's, exact
// except for rounding. The clearance field decides whether the disc is free, so both agree on touching.
//
// Metres. The time is n log n in the number n of straight pieces of obstacles' edges, once for all robots.
#pragma once

#include <memory>
#include <optional>

#include "coppice/planning/clearance_field.h"

namespace coppice {

class VoronoiRoadmap {
 public:
  /// `field` must outlive it.
  explicit VoronoiRoadmap(const ClearanceField& field);
  ~VoronoiRoadmap();

  /// A way of a disc of `radius` (metres) that keeps as far from obstacles as it can. Each of its segments is
  /// free. Nothing if there is no way. Start and goal must be free; the start may lie nearer to an obstacle
  /// by `driving_rounding` (planning/geometry/free_way.h), and then the first segment comes no nearer.
  std::optional<Path> way(const Point2& start, const Point2& goal, double radius) const;

 private:
  class Diagram;
  class Search;

  const ClearanceField& field_;
  std::unique_ptr<const Diagram> diagram_;
};

}  // namespace coppice
