// Grid A* with string pulling: the reference for nearly shortest paths.
//
// The search is 8-connected on the cells whose centre is free (Hart, Nilsson, Raphael, 1968). A diagonal step
// needs both cells beside it: so it cuts no corner of an obstacle. Then points between two points with a free
// line of sight are removed, and the corners of the path are cut. Metres.
#pragma once

#include <vector>

#include "coppice/planning/clearance_field.h"

namespace coppice {

class GridAStar {
 public:
  /// `field` must outlive it. The clearance of a cell is looked up when the search first reaches it.
  explicit GridAStar(const ClearanceField& field);

  /// The path over cell centres, with start and goal; empty if there is none.
  Path path(const Point2& start, const Point2& goal, double radius);
  std::size_t expanded() const { return expanded_; }  ///< cells expanded in all searches

 private:
  const ClearanceField& field_;
  std::vector<float> cost_;
  std::vector<int> parent_;
  std::vector<char> closed_;
  std::size_t expanded_ = 0;
};

}  // namespace coppice
