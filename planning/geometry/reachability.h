// The positions that a disc can certainly reach. Starts and goals are drawn from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coppice/planning/clearance_field.h"

namespace coppice {

/// A part of a map within which a disc can move.
///
/// It is computed by a flood fill over the lattice of half cells: centres and corners of cells, and the
/// middles of their sides. A disc passes between neighbours along the axes if it fits at both, because no
/// blocked cell is nearer in between. Near obstacles it also moves straight to points up to three half cells
/// away. The fill never takes a closed passage for an open one. It is exact for discs up to a cell wide, and
/// for passages along the axes. The time is linear in the size of the part; the memory is a bit for each
/// lattice point and 4 bytes for each position.
class ReachablePart {
 public:
  /// The part that a disc of `radius` (metres) reaches from `from`; empty if the disc does not fit there.
  /// `field` must outlive the part.
  static ReachablePart around(const ClearanceField& field, double radius, const Point2& from);
  /// The part with the most positions; the first of several.
  static ReachablePart largest(const ClearanceField& field, double radius);

  double radius() const { return radius_; }
  /// Positions are the centres of the part's cells, row by row. A part without any, whose passages are an
  /// even number of cells wide, has all its lattice points as positions.
  std::size_t size() const { return places_.size(); }
  bool empty() const { return places_.empty(); }
  Point2 place(std::size_t k) const { return at(places_[k]); }
  /// The bounding box of all positions. The part must not be empty.
  const Box<2>& box() const { return box_; }
  /// Whether the disc can reach p.
  bool contains(const Point2& p) const;

 private:
  ReachablePart(const ClearanceField& field, double radius);

  std::uint32_t columns() const { return 2 * static_cast<std::uint32_t>(field_->frame().width) + 1; }
  std::uint32_t rows() const { return 2 * static_cast<std::uint32_t>(field_->frame().height) + 1; }
  Point2 at(std::uint32_t point) const;
  bool fits(std::uint32_t point) const { return field_->is_free(at(point), radius_); }
  template <class Fn>
  void for_each_joined(const Point2& p, Fn&& fn) const;
  std::size_t flood(std::vector<std::uint32_t> frontier);
  void spread(std::vector<std::uint32_t>& frontier, std::vector<std::uint32_t>& near_obstacles);
  void jump(std::uint32_t from, std::vector<std::uint32_t>& frontier);
  void list_places();

  const ClearanceField* field_;
  double radius_;
  std::vector<bool> reached_;  ///< by lattice point, row by row
  std::vector<std::uint32_t> places_{};
  Box<2> box_{};
};

}  // namespace coppice
