// Passages of a map that are too narrow for three robots side by side: the free space that no free disc of
// three radii covers. In such a passage it matters where robots stand, for none can pass another.
//
// Metres in the map frame.
#pragma once

#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "motion/lattice/lattice.h"

namespace coppice {

class NarrowPassages {
 public:
  using Vertex = Lattice::Vertex;

  /// `field` outlives it. Robots have `radius`; the lattice has `spacing`.
  NarrowPassages(const ClearanceField& field, double radius, double spacing)
      : field_(field), lattice_(field, radius, spacing), wide_(wide_radii * radius) {}

  /// Vertices within `reach` of a centre where passages end or bend: no two free edges lead from them in
  /// opposite directions. Each vertex is returned once, also over several calls.
  std::vector<Vertex> ends(const Point2& centre, double reach);

  /// Points that are at least `apart` from each other, in order along the passages from `end`, up to `reach`
  /// metres from it.
  std::vector<Point2> stack_from(Vertex end, double apart, double reach);

 private:
  static constexpr double wide_radii = 3;

  template <class Fn>
  void for_each_neighbour(Vertex v, Fn&& fn);
  bool is_narrow(Vertex v);

  const ClearanceField& field_;
  Lattice lattice_;
  double wide_;  ///< metres
  std::unordered_set<Vertex> seen_{};
  std::unordered_map<Vertex, bool> narrow_{};
};

}  // namespace coppice
