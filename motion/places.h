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
#include <span>
#include <vector>

#include "motion/lattice.h"
#include "motion/segments.h"
#include "planning/clearance_field.h"
#include "planning/geometry.h"

namespace coppice {

using Place = std::uint32_t;

struct PlaceGraph {
  struct Edge {
    Place to = 0;
    double length = 0;
    Path path{};
    std::vector<Place>
        near{};  ///< where somebody who stands is touched by a robot on the way; `to` among them
  };
  std::vector<Point2> places{};
  std::vector<std::vector<Edge>> edges{};  ///< by the place that they lead from
};

/// A number for each place: the same for those that edges connect.
std::vector<Place> parts_of(const PlaceGraph& graph);

class PackedPlaces {
 public:
  /// `field` outlives it. Places lie on a lattice of `spacing` or a little less.
  PackedPlaces(const ClearanceField& field, double radius, double spacing);

  /// The packed places after `more`, which differ from each other; each is linked to those around it. What
  /// leads past `obstacles`, which stand for ever, is left out.
  PlaceGraph with(std::span<const Point2> more, std::span<const Disc> obstacles);

 private:
  static constexpr Place nowhere = ~Place{0};
  struct Cell {  ///< of a lattice vertex: whose Voronoi cell it lies in
    Place place = nowhere;
    float cost = 0;
    Lattice::Vertex next = 0;  ///< on the way to the place
  };

  void pack();
  void grow_cells();
  void link_cells();
  Path way_to_its_place(Lattice::Vertex v) const;
  Path way_to_a_place(const Point2& p, Place& place);

  const ClearanceField& field_;
  double radius_;
  double touching_;  ///< between centres
  double apart_;     ///< the same, of packed places
  Lattice lattice_;
  std::vector<Point2> places_;
  std::vector<Lattice::Vertex> vertices_;  ///< of the places
  std::vector<Cell> cells_;                ///< of the lattice's vertices
  std::vector<std::vector<PlaceGraph::Edge>> edges_;
};

/// The places of a map, packed when they are first asked for: that takes as long as many a joint plan.
class PlacesOfMap {
 public:
  /// `field` outlives it.
  explicit PlacesOfMap(const ClearanceField& field) : field_(field) {}

  const ClearanceField& field() const { return field_; }
  PackedPlaces& packed(double radius);

 private:
  const ClearanceField& field_;
  std::map<double, PackedPlaces> by_radius_;
};

}  // namespace coppice
