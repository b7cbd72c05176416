// Line-of-sight optimisation of a path, as at the end of MA-RRdT*: points between two points that see each
// other are left out.
#pragma once

#include <vector>

#include "planning/geometry/space.h"

namespace coppice {

/// Number of consecutive invisible points that ends the search for the furthest visible one. Sight past a
/// pillar comes back after a few points; testing all points of a long path would take quadratic time for
/// almost no gain.
inline constexpr std::size_t line_of_sight_misses = 8;

/// Returns the path without the points between two points that see each other: from each point it goes on to
/// the furthest visible one. The ends stay, and the path never becomes longer. `radius`: metres.
template <Space S>
std::vector<Point<S::dimension>> optimise_line_of_sight(const S& space,
                                                        const std::vector<Point<S::dimension>>& path,
                                                        double radius) {
  if (path.size() < 3) return path;
  std::vector<Point<S::dimension>> straight{path.front()};
  for (std::size_t here = 0; here + 1 < path.size();) {
    std::size_t furthest = here + 1;
    for (std::size_t i = here + 2; i < path.size() && i <= furthest + line_of_sight_misses; ++i) {
      if (space.segment_free(path[here], path[i], radius)) furthest = i;
    }
    straight.push_back(path[furthest]);
    here = furthest;
  }
  return straight;
}

}  // namespace coppice
