// Exact Euclidean clearance of a map: the distance from a point to the nearest blocked cell.
//
// The clearance of a point is its distance, in metres, to the nearest blocked cell (a closed square) or to
// the outside of the grid, whichever is nearer; 0 inside of blocked cells. A disc of radius r at p is free
// where clearance(p) >= r: touching is allowed, overlapping is not. A point (r = 0) on an obstacle's edge is
// not free. Touching is decided to within 1e-9 m, because neither p nor r is exact: a disc that is reported
// as free overlaps by less than that.
//
// The squared distance at the centres of the cells is computed once, in time linear in the number of cells
// (Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions", 2012, on the edges of the
// squares). A query first evaluates bounds that are interpolated from these distances. Only if the bounds do
// not decide, it examines the cells themselves. So each answer is exact: a "free" disc never overlaps, and no
// free position is refused.
//
// The bounds hold for this reason: with f the distance to a closed set O, f(p)^2 - |p|^2 = min over q in O of
// |q|^2 - 2 p.q is a minimum of affine functions, hence concave for any O. Jensen's inequality then gives a
// lower bound between known points and an upper bound beyond them; the variance of the weights is the error.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coppice/planning/geometry.h"
#include "coppice/planning/occupancy_map.h"

namespace coppice {

class ClearanceField {
 public:
  static constexpr int dimension = 2;

  /// `inflation`: metres by which all obstacles, and the border, are thicker than the map has them.
  explicit ClearanceField(const OccupancyMap& map, double inflation = 0);

  double inflation() const { return inflation_; }

  const GridFrame& frame() const { return frame_; }
  Box<2> bounds() const { return frame_.bounds(); }

  /// A cheap lower bound of the clearance at p, metres, close to it. 0 where p is not known to be free.
  double lower_bound(const Point2& p) const;

  /// The exact clearance at p, metres; 0 for points outside or NaN.
  double clearance(const Point2& p) const;

  /// Whether a disc of `radius` (metres, >= 0) at p overlaps nothing. Exact. False for points outside or NaN.
  bool is_free(const Point2& p, double radius) const;

  /// Whether a disc of `radius` (metres, >= 0) that moves straight from a to b overlaps nothing on its way.
  /// Exact. False if an end is outside or NaN.
  bool segment_free(const Point2& a, const Point2& b, double radius) const;

  /// The least clearance on the segment from a to b, metres; exact. 0 if an end is outside or NaN.
  double segment_clearance(const Point2& a, const Point2& b) const;

  /// Calls fn(square) with a Box<2>, metres, for each blocked cell that has a free cell at its side and lies
  /// within `distance` (metres) of p, and for some beyond. The squares are not inflated.
  /// The outside of the grid has no cells.
  template <class Fn>
  void for_each_edge_near(const Point2& p, double distance, Fn&& fn) const {
    const Point2 q = to_cells(p);
    if (!contains(q) || !(distance >= 0)) return;
    const Point2 last = extent_ - Point2::Ones();
    const Point2 from = (q.array() - distance * cells_per_metre_).max(0.0).min(last.array());
    const Point2 to = (q.array() + distance * cells_per_metre_).min(last.array());
    for (auto j = static_cast<std::size_t>(from.y()); j <= static_cast<std::size_t>(to.y()); ++j) {
      for_each_edge(j, static_cast<std::size_t>(from.x()), static_cast<std::size_t>(to.x()),
                    [&](std::size_t i) {
                      const Point2 corner(static_cast<double>(i), static_cast<double>(j));
                      fn(Box<2>{frame_.origin + frame_.resolution * corner,
                                frame_.origin + frame_.resolution * (corner + Point2::Ones())});
                    });
    }
  }

 private:
  // Below, points are in cells from the map's origin, and distances are in cells.
  struct Piece;

  Point2 to_cells(const Point2& p) const { return (p - frame_.origin) * cells_per_metre_; }
  bool contains(const Point2& q) const {  // false for NaN
    return q.x() >= 0 && q.y() >= 0 && q.x() <= extent_.x() && q.y() <= extent_.y();
  }
  bool in_blocked_cell(const Point2& q) const {
    return at(std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(q.x()), frame_.width - 1),
              std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(q.y()), frame_.height - 1)) == 0;
  }
  std::int32_t at(std::ptrdiff_t i, std::ptrdiff_t j) const {
    return centre_squared_[static_cast<std::size_t>((j + 1) * stride_ + i + 1)];
  }

  double lower_squared(const Point2& q) const;
  double upper_squared(const Point2& q) const;
  double border_distance(const Point2& q) const { return std::min(q.minCoeff(), (extent_ - q).minCoeff()); }
  double least_squared(const Point2& a, const Point2& b, double limit_squared) const;
  bool piece_free(const Piece& piece, double needed_squared) const;
  void mark_edges(const OccupancyMap& map);
  bool without_edges(const Point2& a, const Point2& b, double margin) const;

  /// Calls fn(i) for the edge cells of row j from column `first` to `last`, which must be inside of the grid.
  template <class Fn>
  void for_each_edge(std::size_t j, std::size_t first, std::size_t last, Fn&& fn) const {
    for (std::size_t word = first / 64; word <= last / 64; ++word) {
      std::uint64_t bits = edges_[j * words_per_row_ + word];
      if (word == first / 64) bits &= ~std::uint64_t{0} << (first % 64);
      if (word == last / 64) bits &= ~std::uint64_t{0} >> (63 - last % 64);
      for (; bits != 0; bits &= bits - 1) fn(word * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
    }
  }

  GridFrame frame_;
  Point2 extent_;  ///< width and height, in cells
  double cells_per_metre_;
  double inflation_;  ///< metres
  std::ptrdiff_t stride_;
  /// The squared distance from each cell's centre to the nearest blocked square or the border, in quarters of
  /// a squared cell, which makes it a whole number. Row by row, with a ring of blocked cells around the grid.
  std::vector<std::int32_t> centre_squared_;
  /// A bit for each blocked cell that has a free cell at its side. No other blocked cell is ever the nearest.
  /// Each row begins a new word.
  std::vector<std::uint64_t> edges_;
  std::size_t words_per_row_;
  /// Whether a tile of tile x tile cells contains an edge cell.
  static constexpr std::size_t tile = 64;
  std::vector<std::uint8_t> tiles_;
};

}  // namespace coppice
