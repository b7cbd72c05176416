// Distances between points and straight segments, at rest and in linear motion. Metres.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "coppice/planning/geometry.h"

namespace coppice {

/// A standing robot.
struct Disc {
  Point2 centre = Point2::Zero();
  double radius = 0;
};

/// Metres that plans keep between standing robots beyond their radii: more than motion/body/promise.h keeps.
inline constexpr double standing_gap = 0.0011;
/// Radii that plans keep between robots beyond touching, where there is room for that. With less, robots slow
/// down beside each other; with more, fewer fit side by side.
inline constexpr double comfort_radii = 0.1;

/// The least distance between two points that move linearly from a0 to a1 and from b0 to b1 in the same time.
inline double closest_approach(const Point2& a0, const Point2& a1, const Point2& b0, const Point2& b1) {
  const Point2 gap = a0 - b0;
  const Point2 change = (a1 - b1) - gap;
  const double squared = change.squaredNorm();
  const double share = squared == 0 ? 0 : std::clamp(-gap.dot(change) / squared, 0.0, 1.0);
  return (gap + share * change).norm();
}

/// The distance from p to the segment from a to b.
inline double point_segment_distance(const Point2& p, const Point2& a, const Point2& b) {
  return closest_approach(p, p, a, b);
}

/// Metres from a along a segment.
struct Chord {
  double begin = 0;
  double end = 0;
};
/// The part of the segment from a to b in a disc; none: it does not meet the disc.
inline std::optional<Chord> chord_in_disc(const Point2& a, const Point2& b, const Point2& centre,
                                          double radius) {
  const double length = (b - a).norm();
  const Point2 gap = centre - a;
  const double middle = length == 0 ? 0 : gap.dot(b - a) / length;
  const double half = std::sqrt(std::max(0.0, radius * radius - gap.squaredNorm() + middle * middle));
  const Chord chord{std::max(0.0, middle - half), std::min(length, middle + half)};
  return half > 0 && chord.begin <= chord.end ? std::optional(chord) : std::nullopt;
}

/// The distance from a point to the nearest of a path's segments. `path` must not be empty.
inline double point_path_distance(const Point2& p, const Path& path) {
  double least = (p - path.front()).norm();
  for (std::size_t k = 1; k < path.size(); ++k)
    least = std::min(least, point_segment_distance(p, path[k - 1], path[k]));
  return least;
}

}  // namespace coppice
