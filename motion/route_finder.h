// Shortest routes of one disc among obstacles and other discs that stand: the building block of plans in
// which robots move one after the other (joint_plan.h).
//
// A* (Hart, Nilsson, Raphael, 1968) on a square lattice over the free space (lattice.h); then shortened. What
// does not lie on the lattice is linked to it by exact checks.
//
// Metres in the map frame.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "motion/lattice.h"
#include "planning/clearance_field.h"
#include "planning/geometry.h"

namespace coppice {

/// What a disc sweeps that moves along a path.
struct Sweep {
  Path path;
  double radius = 0;
};

class RouteFinder {
 public:
  /// For a disc of `radius` on `field`, which outlives it; lattice.h says what becomes of `spacing`.
  RouteFinder(const ClearanceField& field, double radius, double spacing);

  double spacing() const { return lattice_.spacing(); }
  /// Vertices that all searches have looked at, or marked.
  std::size_t effort() const { return effort_; }

  /// From one place to another, past discs that stand. Keeps a comfortable distance where the ends allow it.
  /// Empty if there is none on this lattice, or if a disc stands on the goal.
  Path route(const Point2& from, const Point2& to, std::span<const Disc> discs);

  /// The same, but through the `movable` discs where that is much shorter than around them; past the others.
  Path route_through(const Point2& from, const Point2& to, std::span<const Disc> discs,
                     std::span<const Disc> movable);

  /// To the nearest place outside of the sweeps; through the `movable` discs if need be, past the others.
  /// Places inside of `avoid` count as further away.
  Path refuge(const Point2& from, std::span<const Disc> discs, std::span<const Disc> movable,
              std::span<const Sweep> sweeps, std::span<const Sweep> avoid);

  /// To the nearest place past discs that stand for which wanted() holds; it is asked about each once, the
  /// nearest first.
  Path to_nearest(const Point2& from, std::span<const Disc> discs,
                  const std::function<bool(const Point2&)>& wanted);

  /// Whether places are connected past discs that stand: everything that can be reached from one place.
  /// Returns how many vertices of the lattice that are.
  std::size_t flood(const Point2& from, std::span<const Disc> discs);
  /// Whether the last flood came to `place`.
  bool flooded(const Point2& place);

  /// The discs that a robot on `path` would touch, or come nearer to than route() would.
  std::vector<std::size_t> blockers(const Path& path, std::span<const Disc> discs) const;

 private:
  using Vertex = Lattice::Vertex;
  struct Label {
    std::uint32_t search = 0;
    bool closed = false;
    Vertex parent = 0;
    float cost = 0;
  };
  struct Obstacle {  ///< a disc, with the distance that this robot's centre keeps from its centre
    Point2 centre;
    double distance;
  };
  enum Mark : std::uint8_t { wall = 1, crossing = 2, swept = 4, avoided = 8 };
  struct Goal {
    std::optional<Point2> place{};  ///< none: the nearest vertex that no mark forbids, and that is wanted
    double detour_of_avoided = 0;
    const std::function<bool(const Point2&)>* wanted = nullptr;  ///< of such a vertex; null: any
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
  std::vector<std::uint32_t> marked_;  ///< by which search
  std::vector<std::uint8_t> mark_;
};

/// A spacing at which lattice searches are quick and few passages are missed: metres, for a robot of
/// `radius`.
inline double usual_spacing(double radius) {
  return 0.4 * radius;
}

struct SpacedRoute {
  Path path;     ///< empty: none on any lattice
  double share;  ///< of the usual spacing
};

/// The route on the coarsest lattice that holds one, of `share` of the usual spacing, half of it, and so on
/// down to half a cell, or to as many vertices as are looked through at once.
SpacedRoute coarsest_route(const ClearanceField& field, double radius, const Point2& from, const Point2& to,
                           std::span<const Disc> discs, double share);

}  // namespace coppice
