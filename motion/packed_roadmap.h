// Places where the robots of a crowd can stand side by side, and how one gets from place to place past the
// others: the roadmap of motion/lacam.h.
//
// Places are packed greedily over the free space, those nearest to obstacles first: so a corridor that is
// wide enough gets two lanes, and a door its middle. They lie so far apart that robots on all of them touch
// nobody. Those are linked whose Voronoi cells touch, by path length: places are connected where the lattice
// is. Each edge knows which places must be empty while somebody drives along it. To these come the places
// where the robots stand and where they want to go.
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

#include "motion/annotated_roadmap.h"
#include "motion/lattice.h"
#include "motion/segments.h"
#include "planning/clearance_field.h"
#include "planning/geometry.h"
#include "planning/neighbour_grid.h"

namespace coppice {

class PackedRoadmap {
 public:
  /// `field` outlives it. Places lie on a lattice of `spacing` or a little less. Packing begins along the
  /// walls and leaves some room between robots. With an `anchor` it goes from there along the passages, as
  /// close as can be.
  PackedRoadmap(const ClearanceField& field, double radius, double spacing,
                const std::optional<Point2>& anchor = std::nullopt);

  /// The packed places, of which there are size(), and `more`, which differ from each other; each of those is
  /// linked to what is around it. What leads past `obstacles`, which stand for ever, is left out. The graph
  /// stands on this one's.
  AnnotatedRoadmap with(std::span<const Point2> more, std::span<const Disc> obstacles);
  std::size_t size() const { return packed_.size(); }
  std::size_t lattice_size() const { return lattice_.size(); }

  /// Where passages around the `centres` end or bend, nearest first.
  std::vector<Point2> ends(std::span<const Point2> centres) const;
  /// Places that packing has missed around the `centres`: robots stand there one behind the other from the
  /// ends and corners of passages on. In a passage one robot wide it matters where they stand: packing fills
  /// it from any point, and a short branch may get its place in the mouth.
  std::vector<Point2> stacked(std::span<const Point2> centres) const;

 private:
  static constexpr Vertex nowhere = ~Vertex{0};
  struct Crossing {  ///< from one cell into another
    double length;   ///< from place to place
    Lattice::Vertex a;
    Lattice::Vertex b;
  };
  using Crossings = std::map<std::pair<Vertex, Vertex>, Crossing>;  ///< by the places
  static constexpr Lattice::Direction here = 8;                     ///< a place
  static constexpr Lattice::Direction nowhere_to = 9;               ///< no place can be reached

  std::vector<Lattice::Vertex> in_layers();
  std::vector<Lattice::Vertex> from(const Point2& anchor);
  void pack(std::span<const Lattice::Vertex> order);
  void grow_cells();
  Vertex cell(Lattice::Vertex v) const;
  std::vector<Vertex> cells() const;
  Crossings crossings();
  void link(const Crossings& crossings);
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
  double touching_;  ///< between centres
  double apart_;     ///< the same, of packed places
  double reach_;     ///< of the grids
  Lattice lattice_;
  AnnotatedRoadmap packed_;
  std::unordered_map<Lattice::Vertex, Vertex> place_at_;
  std::vector<Lattice::Direction> towards_;      ///< its place, within each lattice vertex's Voronoi cell
  NeighbourGrid<2> grid_;                        ///< of the places
  NeighbourGrid<2> points_of_ways_;              ///< the points that each edge's path is sampled at
  std::vector<std::pair<Vertex, Vertex>> ways_;  ///< by such a point: the ends of the edge, the smaller first
};

/// The places of a map, packed when they are first asked for: that takes as long as many a joint plan.
class MapRoadmaps {
 public:
  /// `field` outlives it.
  explicit MapRoadmaps(const ClearanceField& field) : field_(field) {}

  const ClearanceField& field() const { return field_; }
  /// For robots of `radius`, on a lattice of `spacing` (metres).
  PackedRoadmap& packed(double radius, double spacing);

 private:
  const ClearanceField& field_;
  std::map<std::pair<double, double>, PackedRoadmap> packed_;  ///< by radius and spacing
};

}  // namespace coppice
