// Random places for robots, apart from one another, within the part of a map that they reach.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "planning/neighbour_grid.h"
#include "planning/random.h"
#include "planning/reachability.h"

namespace coppice {

/// What a new place keeps away from: nearer than `distance` to `centre` it may not be.
struct KeepOut {
  Point2 centre;
  double distance = 0;
};

/// A place of the part other than `from` that keeps out of `taken`, at least `least_way` from `from`; where
/// all free places are nearer than that, at least half as far off, or a quarter, and so on. Each such place
/// is equally likely. Nothing only if all places but `from` are taken.
std::optional<Point2> draw_place(const ReachablePart& part, const Point2& from, double least_way,
                                 std::span<const KeepOut> taken, Random& random);

/// Places that are apart by `distance` or more.
class SpacedPlaces {
 public:
  /// They lie in `box`.
  SpacedPlaces(const Box<2>& box, double distance) : grid_(box, distance), distance_(distance) {}
  bool has_room(const Point2& p) const;
  void add(const Point2& p) { grid_.insert(p); }

 private:
  NeighbourGrid<2> grid_;
  double distance_;
};

/// Places of the part that are apart by `distance` or more, found row by row: no other place fits between
/// them. Where rows fill well, that is close to the most.
std::vector<Point2> packed_places(const ReachablePart& part, double distance);

}  // namespace coppice
