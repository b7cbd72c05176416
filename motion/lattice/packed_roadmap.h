// A roadmap on which the robots of a cluster can stand side by side and pass each other. It is the roadmap of
// motion/joint/lacam.h.
//
// Vertices are packed greedily over the free space, those nearest to obstacles first. So a corridor that is
// wide enough gets two lanes, and a door gets a vertex in its middle. Robots on all vertices touch no other
// robot. Vertices whose Voronoi cells (by path length) touch are linked, so the roadmap is connected wherever
// the lattice is. Each edge lists the vertices that must be empty while a robot drives along it. The starts
// and goals of the robots are added as further vertices.
//
// Traffic keeps to the right: where there is room for two lanes, a way costs more in the left one. Such
// one-way streets let many robots pass each other (Cohen, Uras, Koenig, "Feasibility Study: Using Highways
// for Bounded-Suboptimal Multi-Agent Path Finding", 2015).
//
// For robots of one radius. Metres in the map frame.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "motion/lattice/annotated_roadmap.h"
#include "motion/lattice/lattice.h"
#include "motion/trajectory/segments.h"
#include "motion/trajectory/space_time.h"
#include "planning/geometry/neighbour_grid.h"

namespace coppice {

class PackedRoadmap {
 public:
  /// `field` must outlive it. Vertices lie on a lattice of `spacing` or a little less. Without an anchor,
  /// packing begins along the walls and leaves some room between robots. With an `anchor` it goes from there
  /// along the passages, as closely as possible.
  PackedRoadmap(const ClearanceField& field, double radius, double spacing,
                const std::optional<Point2>& anchor = std::nullopt);

  /// The packed roadmap, of size() vertices, with further vertices `more`. These must differ from each other;
  /// each is linked to the vertices around it. Edges that do not pass the `obstacles`, which never move, are
  /// left out. The result refers to this object's roadmap, which must outlive it.
  AnnotatedRoadmap with(std::span<const Point2> more, std::span<const Disc> obstacles);
  std::size_t size() const { return packed_.size(); }
  std::size_t lattice_size() const { return lattice_.size(); }

  /// Positions around the `centres` where passages end or bend, nearest first.
  std::vector<Point2> ends(std::span<const Point2> centres) const;
  /// Positions around the `centres` that packing has missed: robots stand there in a row from the ends and
  /// corners of passages on. In a passage one robot wide the positions matter: packing may fill it from any
  /// point, and a short branch may get its only vertex in its mouth.
  std::vector<Point2> stacked(std::span<const Point2> centres) const;

 private:
  static constexpr Vertex nowhere = ~Vertex{0};
  struct Crossing {  ///< between two touching cells
    double length;   ///< from roadmap vertex to roadmap vertex, metres
    Lattice::Vertex a;
    Lattice::Vertex b;
  };
  using Crossings = std::map<std::pair<Vertex, Vertex>, Crossing>;  ///< by the two roadmap vertices
  static constexpr Lattice::Direction here = 8;        ///< the lattice vertex is a roadmap vertex
  static constexpr Lattice::Direction nowhere_to = 9;  ///< no roadmap vertex can be reached

  std::vector<Lattice::Vertex> in_layers();
  std::vector<Lattice::Vertex> from(const Point2& anchor);
  void pack(std::span<const Lattice::Vertex> order);
  void grow_cells();
  Vertex cell(Lattice::Vertex v) const;
  std::vector<Vertex> cells() const;
  Crossings crossings();
  void link(const Crossings& crossings);
  bool is_right_lane(const Path& path) const;
  void index_ways();
  template <class Fn>
  void for_each_way_near(const Point2& p, double distance, Fn&& fn) const;
  bool passes(std::span<const Disc> obstacles, const Path& path) const;
  void leave_out(std::span<const Disc> obstacles, AnnotatedRoadmap& graph) const;
  double cost(Lattice::Vertex v, double metres) const;
  float cost_to_its_place(Lattice::Vertex v) const;
  Path way_to_its_place(Lattice::Vertex v) const;
  Path way_to_a_place(const Point2& p, Vertex& place);

  const ClearanceField& field_;
  double radius_;
  double touching_;  ///< metres between the centres of robots that touch
  double apart_;     ///< metres between packed vertices
  double reach_;     ///< metres, of the grids
  Lattice lattice_;
  AnnotatedRoadmap packed_;
  std::unordered_map<Lattice::Vertex, Vertex> place_at_;
  /// By lattice vertex: direction towards the roadmap vertex of its cell.
  std::vector<Lattice::Direction> towards_;
  NeighbourGrid<2> grid_;                        ///< grid of the vertices
  NeighbourGrid<2> points_of_ways_;              ///< grid of the points at which the edges' paths are sampled
  std::vector<std::pair<Vertex, Vertex>> ways_;  ///< by such a point: the ends of its edge, the smaller first
};

/// One roadmap for robots of several sizes: all vertices and edges of the parts, one after the other. Each
/// part has the vertices of one size, and a robot stays on the part of its size.
AnnotatedRoadmap united(std::span<const AnnotatedRoadmap> parts, const Box<2>& bounds);

/// The packed roadmaps and lattices of a map. Each is made when it is first requested, because packing takes
/// as long as many joint plans.
///
/// A map may be too large for them. Then trajectories are searched on lattices of its parts, and no joint
/// plans are made.
class MapRoadmaps {
 public:
  /// `field` must outlive it.
  explicit MapRoadmaps(const ClearanceField& field) : field_(field) {}

  const ClearanceField& field() const { return field_; }
  /// The roadmap for robots of `radius` on a lattice of `spacing` (metres).
  PackedRoadmap& packed(double radius, double spacing);
  /// Whether the map is small enough for a packed roadmap.
  bool can_pack(double radius) const;
  /// Whether the map is small enough for a lattice.
  bool has_lattice(double radius) const {
    return Lattice::size_of_walls(field_, field_.bounds(), trajectory_spacing_radii * radius) <=
           most_vertices;
  }
  /// The lattice on which robots of `radius` search trajectories.
  Lattice& lattice(double radius) {
    const auto known = lattices_.find(radius);
    if (known != lattices_.end()) return known->second;
    return lattices_.emplace(radius, lattice_of(field_.bounds(), radius)).first->second;
  }
  /// The lattice of a part of the map.
  Lattice lattice_of(const Box<2>& part, double radius) const {
    return Lattice::of_walls(field_, part, (1 + reserved_stray_radii) * radius,
                             trajectory_spacing_radii * radius, fine_within_radii * radius);
  }

 private:
  static constexpr double most_vertices = 8e6;  ///< of a lattice: 4 bytes each, and 9 more in a search
  static constexpr double most_places = 1.5e6;  ///< of a packed roadmap: about 1.7 kB each
  static constexpr double trajectory_spacing_radii = 0.5;
  static constexpr double fine_within_radii = 2.5;  ///< from obstacles

  const ClearanceField& field_;
  std::map<std::pair<double, double>, PackedRoadmap> packed_;  ///< by radius and spacing
  std::map<double, Lattice> lattices_;                         ///< by radius
};

}  // namespace coppice
