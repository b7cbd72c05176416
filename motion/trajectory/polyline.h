// A path that is parameterised by the distance along it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "coppice/planning/geometry.h"

namespace coppice {

/// Metres in the map frame. At least one point.
struct Polyline {
  Path points;
  std::vector<double> along;  ///< distance of each point from the beginning, metres

  explicit Polyline(Path path) : points(std::move(path)) {
    along.push_back(0);
    for (std::size_t i = 1; i < points.size(); ++i)
      along.push_back(along.back() + (points[i] - points[i - 1]).norm());
  }

  double length() const { return along.back(); }
  /// The point at `distance` metres from the beginning; clamped to the ends.
  Point2 at(double distance) const {
    const auto next = std::upper_bound(along.begin(), along.end(), distance);
    if (next == along.end()) return points.back();
    if (next == along.begin()) return points.front();
    const auto i = static_cast<std::size_t>(next - along.begin());
    const double share = (distance - along[i - 1]) / (along[i] - along[i - 1]);
    return points[i - 1] + share * (points[i] - points[i - 1]);
  }
};

}  // namespace coppice
