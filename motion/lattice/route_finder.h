// Shortest routes of one disc among obstacles and other, standing discs.
//
// A* (Hart, Nilsson, Raphael, 1968) on a square lattice over the free space (lattice.h); the route is then
// shortened. Points off the lattice are linked to it by exact checks.
//
// Metres in the map frame.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "motion/lattice/lattice.h"

namespace coppice {

class RouteFinder {
 public:
  /// Routes of a disc of `radius` (metres) on `field`, which must outlive it. lattice.h tells how `spacing`
  /// (metres) is rounded.
  RouteFinder(const ClearanceField& field, double radius, double spacing);

  double spacing() const { return lattice_.spacing(); }

  /// The route from one position to another past standing discs. It keeps a comfortable distance if the ends
  /// allow that. Empty if there is none on this lattice, or if a disc stands on the goal.
  Path route(const Point2& from, const Point2& to, std::span<const Disc> discs);

 private:
  using Vertex = Lattice::Vertex;
  struct Label {
    std::uint32_t search = 0;
    bool closed = false;
    Vertex parent = 0;
    float cost = 0;
  };
  struct Obstacle {  ///< a disc, with the distance that this robot's centre keeps from the disc's centre
    Point2 centre;
    double distance;
  };
  bool passable(Vertex v) const { return wall_[v] != search_; }
  void begin_search();
  void mark_walls(std::span<const Obstacle> walls);
  std::vector<Obstacle> obstacles(std::span<const Disc> discs, const Point2& from, const Point2& to) const;
  template <class Fn>
  void for_each_link(const Point2& p, std::span<const Obstacle> obstacles, Fn&& fn);
  Path search(const Point2& from, const Point2& to, std::span<const Obstacle> walls);

  const ClearanceField& field_;
  double radius_;
  Lattice lattice_;
  std::uint32_t search_ = 0;
  std::vector<Label> labels_;
  std::vector<std::uint32_t> wall_;  ///< by vertex: number of the search in which a disc is too near
};

/// A spacing, metres, for a robot of `radius`, at which lattice searches are fast and miss few passages.
inline double usual_spacing(double radius) {
  return 0.4 * radius;
}

/// The route on the coarsest lattice that holds one; empty: none does. The spacing is the usual one, then
/// half of that, and so on, down to half a cell or to the largest number of vertices that is searched.
Path coarsest_route(const ClearanceField& field, double radius, const Point2& from, const Point2& to,
                    std::span<const Disc> discs);

}  // namespace coppice
