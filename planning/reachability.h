// Where a disc can go: the places that it surely reaches, from which starts and goals are drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "planning/clearance_field.h"

namespace coppice {

/// The part of a map that a disc can move in without leaving it.
///
/// A flood fill over the lattice of half cells: cells' centres, corners, and the middles of their sides.
/// Between neighbours along the axes a disc passes where it fits at both, for no blocked cell is nearer in
/// between. Near obstacles it also goes straight to points up to three half cells off. This never takes a
/// closed passage for an open one. It is exact for discs up to a cell wide, and for passages along the axes.
/// Time linear in the part, memory a bit for each lattice point and four bytes for each place.
class ReachablePart {
 public:
  /// All that a disc of `radius` reaches from `from`; no places if it does not fit there. `field` outlives
  /// the part.
  static ReachablePart around(const ClearanceField& field, double radius, const Point2& from);
  /// The part with the most places; the first of several.
  static ReachablePart largest(const ClearanceField& field, double radius);

  double radius() const { return radius_; }
  /// Places: the centres of the part's cells, row by row. A part without any, whose passages are an even
  /// number of cells wide, has all its lattice points instead.
  std::size_t size() const { return places_.size(); }
  bool empty() const { return places_.empty(); }
  Point2 place(std::size_t k) const { return at(places_[k]); }
  /// Around all places. There is at least one.
  const Box<2>& box() const { return box_; }
  /// Whether the disc comes to p.
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
