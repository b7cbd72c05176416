// Exact Euclidean clearance of a map: how far a point is from the nearest blocked cell.
//
// The clearance of a point is its distance, in metres, to the nearest blocked cell (a closed square) or to
// the outside of the grid, whichever is nearer; 0 inside of blocked cells. A disc of radius r at p is free
// where clearance(p) >= r: touching is allowed, overlapping is not.
//
// The distance at the cells' centres is computed once, in time linear in the cells (Felzenszwalb and
// Huttenlocher, "Distance Transforms of Sampled Functions", 2012, on distances to squares). A query first
// asks a lower bound interpolated from these; only where the bound leaves the answer open does it look at
// the cells themselves. So every answer is exact: a "free" never touches, and no free place is refused.
#pragma once

#include <vector>

#include "planning/geometry.h"
#include "planning/occupancy_map.h"

namespace coppice {

class ClearanceField {
 public:
  static constexpr int dimension = 2;

  explicit ClearanceField(OccupancyMap map);

  const OccupancyMap& map() const { return map_; }
  Box<2> bounds() const { return map_.bounds(); }

  /// Never above the clearance at p, and close to it; cheap. Negative or 0 where p is not known to be free.
  double lower_bound(const Point2& p) const;

  /// The exact clearance at p, metres.
  double clearance(const Point2& p) const;

  /// Whether a disc of `radius` (metres, >= 0) at p overlaps nothing. Exact. False for points outside or NaN.
  bool is_free(const Point2& p, double radius) const;

  /// Whether a disc of `radius` that moves straight from a to b overlaps nothing on its way. Exact.
  bool segment_free(const Point2& a, const Point2& b, double radius) const;

  /// The least clearance on the segment from a to b, metres, to within `tolerance` and never above the truth.
  double segment_clearance(const Point2& a, const Point2& b, double tolerance = 0.01) const;

 private:
  OccupancyMap map_;
  /// Distance from each cell's centre to the nearest blocked square or the border, in cells; row by row.
  std::vector<float> centre_distance_;
};

}  // namespace coppice
