// Random positions for robots, apart from one another, within the part of a map that they can reach.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "coppice/planning/random.h"
#include "planning/geometry/neighbour_grid.h"
#include "planning/geometry/reachability.h"

namespace coppice {

/// A disc to avoid: a new position must be at least `distance` (metres) from `centre`.
struct KeepOut {
  Point2 centre;
  double distance = 0;
};

/// A position of the part other than `from` that is outside of all discs of `taken` and at least `least_way`
/// metres from `from`. If all free positions are nearer, at least half as far, or a quarter, and so on. Each
/// such position is equally likely. Nothing only if all positions except `from` are taken.
std::optional<Point2> draw_place(const ReachablePart& part, const Point2& from, double least_way,
                                 std::span<const KeepOut> taken, Random& random);

/// A set of positions that are at least `distance` (metres) apart.
class SpacedPlaces {
 public:
  /// All positions must lie in `box`.
  SpacedPlaces(const Box<2>& box, double distance) : grid_(box, distance), distance_(distance) {}
  bool has_room(const Point2& p) const;
  void add(const Point2& p) { grid_.insert(p); }

 private:
  NeighbourGrid<2> grid_;
  double distance_;
};

/// Positions of the part that are at least `distance` apart, found row by row so that no other position fits
/// between them. Where rows fill well, the number is close to the largest possible one.
std::vector<Point2> packed_places(const ReachablePart& part, double distance);

}  // namespace coppice
