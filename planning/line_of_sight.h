// Line-of-sight optimisation of a path, as at the end of MA-RRdT*: points between two that see each other are
// left out.
#pragma once

#include <vector>

#include "planning/space.h"

namespace coppice {

/// The path with every detour between two of its points that see each other cut short; the shortest such
/// selection of its points (dynamic programming over all pairs costs too much for long paths, so from each
/// point on the furthest visible one is taken). Ends stay; it never becomes longer.
template <Space S>
std::vector<Point<S::dimension>> optimise_line_of_sight(const S& space,
                                                        const std::vector<Point<S::dimension>>& path,
                                                        double radius) {
  if (path.size() < 3) return path;
  std::vector<Point<S::dimension>> straight{path.front()};
  for (std::size_t here = 0; here + 1 < path.size();) {
    std::size_t furthest = path.size() - 1;
    while (furthest > here + 1 && !space.segment_free(path[here], path[furthest], radius)) --furthest;
    straight.push_back(path[furthest]);
    here = furthest;
  }
  return straight;
}

}  // namespace coppice
