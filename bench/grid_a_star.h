// Grid A* with string pulling: the peer that gives nearly the shortest paths.
//
// 8-connected on the cells whose centre is free (Hart, Nilsson, Raphael, 1968), then points between two that
// see each other are left out, and corners are cut. Metres.
#pragma once

#include <vector>

#include "planning/clearance_field.h"

namespace coppice {

class GridAStar {
 public:
  /// `field` outlives it. Cells are asked for their clearance when they are first seen.
  explicit GridAStar(const ClearanceField& field);

  /// Over cell centres, start and goal added; empty if there is none.
  Path path(const Point2& start, const Point2& goal, double radius);
  std::size_t expanded() const { return expanded_; }  ///< cells in all searches

 private:
  const ClearanceField& field_;
  std::vector<float> cost_;
  std::vector<int> parent_;
  std::vector<char> closed_;
  std::size_t expanded_ = 0;
};

}  // namespace coppice
