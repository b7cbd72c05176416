// The way of a disc, or the proof that there is none: what a sampling planner cannot give where a passage is
// as wide as the disc, or closed.
//
// The retraction method (O'Dunlaing and Yap, "A Retraction Method for Planning the Motion of a Disc", 1985):
// a disc can go from start to goal if and only if it can go straight away from what is nearest, onto the
// Voronoi diagram of the obstacles' edges; then along that; and the same from the goal. So passages as wide
// as the disc are found as surely as wide ones. The diagram is Boost.Polygon's, exact but for rounding;
// whether the disc is free is the clearance field's word, so both agree on what touches.
//
// Metres. Time n log n in the n straight pieces of obstacles' edges, once for all robots.
#pragma once

#include <memory>
#include <optional>

#include "planning/clearance_field.h"

namespace coppice {

class VoronoiRoadmap {
 public:
  /// `field` outlives it.
  explicit VoronoiRoadmap(const ClearanceField& field);
  ~VoronoiRoadmap();

  /// A way of a disc of `radius`, as far from what is near as it can be; each of its segments is free.
  /// Nothing if there is none. Start and goal are free.
  std::optional<Path> way(const Point2& start, const Point2& goal, double radius) const;

 private:
  class Diagram;
  class Search;

  const ClearanceField& field_;
  std::unique_ptr<const Diagram> diagram_;
};

}  // namespace coppice
