// Shortest routes of one disc among obstacles and other, standing discs. Plans in which robots move one after
// the other (joint_plan.h) are made of them.
//
// A* (Hart, Nilsson, Raphael, 1968) on a square lattice over the free space (lattice.h); the route is then
// shortened. Points off the lattice are linked to it by exact checks.
//
// Metres in the map frame.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "motion/lattice/lattice.h"

namespace coppice {

/// The area that a disc covers as it moves along a path.
struct Sweep {
  Path path;
  double radius = 0;
};

class RouteFinder {
 public:
  /// Routes of a disc of `radius` (metres) on `field`, which must outlive it. lattice.h tells how `spacing`
  /// (metres) is rounded.
  RouteFinder(const ClearanceField& field, double radius, double spacing);

  double spacing() const { return lattice_.spacing(); }
  /// Number of vertices that all searches have examined or marked.
  std::size_t effort() const { return effort_; }

  /// The route from one position to another past standing discs. It keeps a comfortable distance if the ends
  /// allow that. Empty if there is none on this lattice, or if a disc stands on the goal.
  Path route(const Point2& from, const Point2& to, std::span<const Disc> discs);

  /// The route past `discs`, but through the `movable` discs where that is much shorter than around them.
  Path route_through(const Point2& from, const Point2& to, std::span<const Disc> discs,
                     std::span<const Disc> movable);

  /// The route to the nearest position outside of the sweeps, past `discs`, and through `movable` discs if
  /// need be. Positions inside of `avoid` count as further away.
  Path refuge(const Point2& from, std::span<const Disc> discs, std::span<const Disc> movable,
              std::span<const Sweep> sweeps, std::span<const Sweep> avoid);

  /// The route past standing discs to the nearest position for which wanted() holds. wanted() is called once
  /// for each position, the nearest first.
  Path to_nearest(const Point2& from, std::span<const Disc> discs,
                  const std::function<bool(const Point2&)>& wanted);

  /// Finds all vertices that can be reached from a position past standing discs. Returns their number.
  std::size_t flood(const Point2& from, std::span<const Disc> discs);
  /// Whether the last flood reached `place`.
  bool flooded(const Point2& place);

  /// The discs that a robot on `path` would touch, or to which it would come nearer than route() does.
  std::vector<std::size_t> blockers(const Path& path, std::span<const Disc> discs) const;

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
  enum Mark : std::uint8_t { wall = 1, crossing = 2, swept = 4, avoided = 8 };
  struct Goal {
    std::optional<Point2> place{};  ///< none: the nearest vertex that no mark forbids and that is wanted
    double detour_of_avoided = 0;
    /// Whether such a vertex is wanted; null: any is.
    const std::function<bool(const Point2&)>* wanted = nullptr;
  };

  std::uint8_t marks(Vertex v) const { return marked_[v] == search_ ? mark_[v] : 0; }
  bool passable(Vertex v) const { return (marks(v) & wall) == 0; }
  void begin_search();
  void mark(const Point2& a, const Point2& b, double distance, Mark what);
  void mark_walls(std::span<const Obstacle> walls);
  std::vector<Obstacle> obstacles(std::span<const Disc> discs, const Point2& from,
                                  const std::optional<Point2>& to) const;
  template <class Fn>
  void for_each_link(const Point2& p, std::span<const Obstacle> obstacles, Fn&& fn);
  template <class Fn>
  void for_each_neighbour(Vertex v, Fn&& fn);
  Path search(const Point2& from, const Goal& goal, std::span<const Obstacle> walls);
  Path straightened(Path path, std::span<const Obstacle> walls) const;

  const ClearanceField& field_;
  double radius_;
  Lattice lattice_;
  std::uint32_t search_ = 0;
  std::size_t effort_ = 0;
  std::vector<Label> labels_;
  std::vector<std::uint32_t> marked_;  ///< by vertex: number of the search that marked it
  std::vector<std::uint8_t> mark_;
};

/// A spacing, metres, for a robot of `radius`, at which lattice searches are fast and miss few passages.
inline double usual_spacing(double radius) {
  return 0.4 * radius;
}

struct SpacedRoute {
  Path path;     ///< empty: none on any lattice
  double share;  ///< share of the usual spacing
};

/// The route on the coarsest lattice that holds one. The spacing is `share` of the usual one, then half of
/// that, and so on, down to half a cell or to the largest number of vertices that is searched.
SpacedRoute coarsest_route(const ClearanceField& field, double radius, const Point2& from, const Point2& to,
                           std::span<const Disc> discs, double share);

}  // namespace coppice
