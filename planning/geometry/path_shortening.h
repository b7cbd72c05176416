// Shortens a path within its homotopy class, until it lies nearly taut around the obstacles.
//
// Line of sight only leaves points out, so the path still turns at randomly sampled nodes. Here corners are
// cut: as much of the two edges that meet at a point as possible is replaced by a straight line between them.
// A path that touches an obstacle becomes a chain of short chords around it. (Shortcuts between points on
// edges, rather than between nodes: Geraerts and Overmars, "Creating High-quality Paths for Motion Planning",
// 2007.)
#pragma once

#include <algorithm>
#include <vector>

#include "coppice/planning/geometry.h"
#include "planning/geometry/line_of_sight.h"
#include "planning/geometry/space.h"

namespace coppice {

namespace shortening {

inline constexpr int most_rounds = 12;      // each round gains less; further rounds are not worth their time
inline constexpr double least_gain = 1e-3;  // share of the length; a round that gains less is the last
inline constexpr int halvings = 6;          // of the cut, until it is free
// Share of the two edges' length that a corner's detour must exceed.
inline constexpr double least_detour = 1e-3;

/// Cuts the corner at `corner` between `before` and `after`. `from` and `to` become the ends of the largest
/// free chord among cuts of 1, 1/2, 1/4, ... of the shorter edge. Returns false if none is free.
template <Space S>
bool cut_corner(const S& space, const Point<S::dimension>& before, const Point<S::dimension>& corner,
                const Point<S::dimension>& after, double radius, Point<S::dimension>& from,
                Point<S::dimension>& to) {
  const double in = (corner - before).norm();
  const double out = (after - corner).norm();
  if (in + out - (after - before).norm() < least_detour * (in + out)) return false;
  double cut = std::min(in, out);
  for (int i = 0; i < halvings; ++i, cut /= 2) {
    from = corner + (before - corner) * (cut / in);
    to = corner + (after - corner) * (cut / out);
    if (space.segment_free(from, to, radius)) return true;
  }
  return false;
}

template <Space S>
std::vector<Point<S::dimension>> cut_corners(const S& space, const std::vector<Point<S::dimension>>& path,
                                             double radius) {
  std::vector<Point<S::dimension>> cut{path.front()};
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    Point<S::dimension> from;
    Point<S::dimension> to;
    if (!cut_corner(space, cut.back(), path[i], path[i + 1], radius, from, to)) {
      cut.push_back(path[i]);
      continue;
    }
    if ((from - cut.back()).norm() > 1e-9) cut.push_back(from);
    cut.push_back(to);
  }
  if ((cut.back() - path.back()).norm() > 1e-9) {
    cut.push_back(path.back());
  } else {
    cut.back() = path.back();
  }
  return cut;
}

}  // namespace shortening

/// Returns a path with the same ends that is free for `radius` and never longer. Metres.
template <Space S>
std::vector<Point<S::dimension>> shorten(const S& space, std::vector<Point<S::dimension>> path,
                                         double radius) {
  path = optimise_line_of_sight(space, path, radius);
  double length = length_of(path);
  for (int round = 0; round < shortening::most_rounds && path.size() > 2; ++round) {
    std::vector<Point<S::dimension>> next =
        optimise_line_of_sight(space, shortening::cut_corners(space, path, radius), radius);
    const double next_length = length_of(next);
    if (next_length >= length) break;
    const bool done = length - next_length < shortening::least_gain * length;
    path = std::move(next);
    length = next_length;
    if (done) break;
  }
  return path;
}

}  // namespace coppice
