// A way whose first part is planned, and the rest of it later.
//
// Metres in the map frame.
#pragma once

#include <algorithm>
#include <cstddef>

#include "coppice/planning/geometry.h"

namespace coppice {

struct DividedWay {
  Path first;   ///< at least one point
  Path rest{};  ///< from the end of the first part to the end of the way; empty: the first part is all
};

/// The first part has at most so many metres, and corners. `way`: at least one point.
inline DividedWay divided(const Path& way, double longest, std::size_t corners) {
  DividedWay parts{{way.front()}};
  for (std::size_t k = 1; k < way.size(); ++k) {
    const double length = (way[k] - way[k - 1]).norm();
    const bool ends_here = length > longest;
    parts.first.push_back(ends_here ? Point2(way[k - 1] + longest / length * (way[k] - way[k - 1])) : way[k]);
    longest -= length;
    if (!ends_here && (k + 1 == way.size() || k <= corners)) continue;
    parts.rest = {parts.first.back()};
    parts.rest.insert(parts.rest.end(), way.begin() + static_cast<std::ptrdiff_t>(ends_here ? k : k + 1),
                      way.end());
    break;
  }
  return parts;
}

}  // namespace coppice
