// A square lattice over the free space of a disc, on which searches for several robots run.
//
// Each vertex and edge is checked exactly when it is first used. Lattice points lie at multiples of half a
// cell, so that they hit the middle of a corridor of any width.
//
// A lattice of walls is fine near obstacles only, and follows them: a vertex that is too close to a wall is
// moved off it, by half a spacing at most. So no passage is missed because it lies between two rows, and
// robots find two lanes where there is room for two.
//
// Metres in the map frame.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"
#include "motion/trajectory/segments.h"

namespace coppice {

class Lattice {
 public:
  using Vertex = std::uint32_t;
  using Direction = std::uint8_t;  ///< of an edge: 0 to 7, counterclockwise from +x (the signs in `steps`)

  /// The lattice of a disc of `radius` (metres) on `field`, which must outlive it. The spacing is `spacing`
  /// (metres) rounded down to a multiple of half a cell, but not below that.
  Lattice(const ClearanceField& field, double radius, double spacing);
  /// The lattice of walls over a part of the map. Vertices further than `fine_within` (metres) from obstacles
  /// lie two spacings apart, those that are twice as far four, and so on up to `coarsest`. Where half a cell
  /// is more than `spacing`, the spacing is a part of half a cell. On a part that is too large for that, the
  /// spacing is twice as large everywhere, and at least half a cell.
  static Lattice of_walls(const ClearanceField& field, const Box<2>& part, double radius, double spacing,
                          double fine_within);
  /// The number of its vertices, about.
  static double size_of_walls(const ClearanceField& field, const Box<2>& part, double spacing);

  double spacing() const { return spacing_; }
  std::size_t size() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }
  Point2 at(Vertex v) const {
    const Point2 p =
        origin_ + spacing_ * Point2(static_cast<int>(v) % columns_, static_cast<int>(v) / columns_);
    return shifts_.empty() ? p : Point2(p + shift(v));
  }

  bool vertex_free(Vertex v) {
    if (known_vertex_[v] == unknown) known_vertex_[v] = look_at(v);
    return known_vertex_[v] != blocked && known_vertex_[v] != left_out;
  }

  /// Calls fn(vertex, metres) for each neighbour of v that a free edge leads to and for which
  /// passable(vertex) holds.
  template <class Passable, class Fn>
  void for_each_neighbour(Vertex v, Passable&& passable, Fn&& fn) {
    const int i = static_cast<int>(v) % columns_;
    const int j = static_cast<int>(v) / columns_;
    for (std::size_t d = 0; d < steps.size(); ++d) {
      const auto [di, dj] = steps[d];
      // Across vertices that are left out, to the next one that is not. No obstacle is near enough to block
      // an edge through these.
      for (int step = 1; step <= coarsest && contains(i + step * di, j + step * dj); step *= 2) {
        const Vertex w = vertex(i + step * di, j + step * dj);
        if (!passable(w)) break;
        if (vertex_free(w)) {
          if (step > 1 || edge_free(v, w, d))
            fn(w, is_of_walls() ? (at(w) - at(v)).norm() : length(static_cast<Direction>(d)));
          break;
        }
        if (known_vertex_[w] != left_out) break;
      }
    }
  }

  /// Frees what is known of vertices and edges, 2 bytes a vertex. No vertex or edge may be queried
  /// afterwards.
  void forget() {
    std::vector<Known>().swap(known_vertex_);
    std::vector<std::uint8_t>().swap(known_edges_);
  }

  /// The length of an edge, metres.
  double length(Direction d) const { return d % 2 == 0 ? spacing_ : spacing_ * std::numbers::sqrt2; }
  /// The direction of the edge from a vertex to a neighbour.
  Direction direction(Vertex from, Vertex to) const {
    const Step step{static_cast<int>(to) % columns_ - static_cast<int>(from) % columns_,
                    static_cast<int>(to) / columns_ - static_cast<int>(from) / columns_};
    return static_cast<Direction>(std::ranges::find(steps, step) - steps.begin());
  }
  /// The neighbour to which the edge in this direction leads.
  Vertex beside(Vertex from, Direction direction) const {
    return from + static_cast<Vertex>(steps[direction].dj * columns_ + steps[direction].di);
  }

  /// Columns and rows on each side of a point off the lattice: it is linked to the vertices among them.
  static constexpr int usual_reach = 2;
  /// The most spacings between neighbours of a lattice of walls.
  static constexpr int coarsest = 4;

  /// Calls fn(vertex) for the vertices around p, free or not: `reach` columns and rows on each side.
  template <class Fn>
  void for_each_around(const Point2& p, int reach, Fn&& fn) const {
    const Point2 q = (p - origin_) / spacing_;
    const int i0 = static_cast<int>(std::floor(q.x()));
    const int j0 = static_cast<int>(std::floor(q.y()));
    for (int j = std::max(0, j0 + 1 - reach); j <= std::min(rows_ - 1, j0 + reach); ++j) {
      for (int i = std::max(0, i0 + 1 - reach); i <= std::min(columns_ - 1, i0 + reach); ++i) {
        fn(vertex(i, j));
      }
    }
  }

  /// Calls fn(vertex) for the vertices, free or not, that are nearer than `distance` to the segment from a to
  /// b.
  template <class Fn>
  void for_each_near(const Point2& a, const Point2& b, double distance, Fn&& fn) const {
    const auto cell = [&](double metres, int most) {
      return std::clamp(static_cast<int>(std::floor(metres / spacing_)), 0, most);
    };
    const double least_y = std::min(a.y(), b.y()) - distance - origin_.y();
    const double most_y = std::max(a.y(), b.y()) + distance - origin_.y();
    for (int j = cell(least_y, rows_ - 1); j <= cell(most_y + spacing_, rows_ - 1); ++j) {
      // Only the part of the segment within `distance` of the row matters.
      const double row = origin_.y() + j * spacing_;
      const auto clipped = [&](double y) {
        return std::clamp(y, std::min(a.y(), b.y()), std::max(a.y(), b.y()));
      };
      const auto x_at = [&](double y) {
        return a.x() + (b.x() - a.x()) * (clipped(y) - a.y()) / (b.y() - a.y());
      };
      const bool level = a.y() == b.y();
      const double x0 = level ? a.x() : x_at(row - distance);
      const double x1 = level ? b.x() : x_at(row + distance);
      const double least_x = std::min(x0, x1) - distance - origin_.x();
      const double most_x = std::max(x0, x1) + distance - origin_.x();
      for (int i = cell(least_x, columns_ - 1); i <= cell(most_x + spacing_, columns_ - 1); ++i) {
        const Vertex v = vertex(i, j);
        if (point_segment_distance(at(v), a, b) < distance) fn(v);
      }
    }
  }

 private:
  /// wide: all edges from the vertex are free. left_out: it is free, but no vertex of this lattice of walls.
  enum Known : std::uint8_t { unknown, blocked, free_, wide, left_out };
  struct Step {
    int di;
    int dj;
    bool operator==(const Step&) const = default;
  };
  /// From the place on the lattice to that of the vertex, in shift_unit().
  struct Shift {
    std::int8_t i;
    std::int8_t j;
  };
  static constexpr double most_shift = 127;
  // The first four edges are stored at the vertex that they start from, the others at the vertex that they
  // lead to.
  static constexpr std::array<Step, 8> steps{
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

  Lattice(const ClearanceField& field, const Box<2>& part, double radius, double spacing, double fine_within);
  bool contains(int i, int j) const { return i >= 0 && i < columns_ && j >= 0 && j < rows_; }
  Vertex vertex(int i, int j) const { return static_cast<Vertex>(j * columns_ + i); }
  bool is_of_walls() const { return !shifts_.empty(); }
  Known look_at(Vertex v);
  bool shift_off_wall(Vertex v);
  double shift_unit() const { return spacing_ / 2 / most_shift; }
  Point2 shift(Vertex v) const { return shift_unit() * Point2(shifts_[v].i, shifts_[v].j); }
  /// Both vertices must be free.
  bool edge_free(Vertex v, Vertex w, std::size_t direction);

  const ClearanceField& field_;
  double radius_;
  double spacing_;
  double fine_within_;
  Point2 origin_;
  int columns_;
  int rows_;
  std::vector<Known> known_vertex_;
  std::vector<Shift> shifts_{};              ///< by vertex of a lattice of walls
  std::vector<std::uint8_t> known_edges_{};  ///< to E, NE, N, NW: 2 bits each; empty: no edge is known
};

}  // namespace coppice
