#include "motion/lattice/lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "motion/lattice/off_walls.h"

namespace coppice {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double most_vertices = 1e6;  // of a fine lattice: a search takes 8 bytes for each

/// The largest multiple of half a cell that is at most `wanted`; at least half a cell.
double on_half_cells(double wanted, double resolution) {
  const double half = resolution / 2;
  return half * std::max(1.0, std::floor(wanted / half));
}

/// The same, but half a cell is divided if that is too much.
double on_parts_of_cells(double wanted, double resolution) {
  const double half = resolution / 2;
  return wanted < half ? half / std::round(half / wanted) : on_half_cells(wanted, resolution);
}

/// In a lattice of that spacing over a part of the map, about.
double vertices(const Box<2>& part, double spacing) {
  return (part.upper - part.lower).prod() / (spacing * spacing);
}

}  // namespace

Lattice::Lattice(const ClearanceField& field, double radius, double spacing)
    : Lattice(field, field.bounds(), radius, on_half_cells(spacing, field.frame().resolution), infinity) {}

Lattice Lattice::of_walls(const ClearanceField& field, const Box<2>& part, double radius, double spacing,
                          double fine_within) {
  const double resolution = field.frame().resolution;
  const double fine = on_parts_of_cells(spacing, resolution);
  const bool is_large = vertices(part, fine) > most_vertices;
  const double exact = is_large ? on_half_cells(2 * spacing, resolution) : fine;
  const double all = radius + exact * std::numbers::sqrt2;
  Lattice lattice(field, part, radius, exact, is_large ? infinity : std::max(fine_within, all));
  lattice.shifts_.assign(lattice.size(), {0, 0});
  return lattice;
}

double Lattice::size_of_walls(const ClearanceField& field, const Box<2>& part, double spacing) {
  const double resolution = field.frame().resolution;
  const double fine = vertices(part, on_parts_of_cells(spacing, resolution));
  return fine > most_vertices ? vertices(part, on_half_cells(2 * spacing, resolution)) : fine;
}

/// The part begins at a multiple of half a cell.
Lattice::Lattice(const ClearanceField& field, const Box<2>& part, double radius, double spacing,
                 double fine_within)
    : field_(field), radius_(radius), spacing_(spacing), fine_within_(fine_within) {
  const Box<2> box = field.bounds();
  const double half = field.frame().resolution / 2;
  const Point2 before = ((part.lower - box.lower) / half).array().floor().max(0) * half;
  origin_ = box.lower + before;
  const Point2 extent = part.upper.cwiseMin(box.upper) - origin_;
  columns_ = static_cast<int>(extent.x() / spacing_) + 1;
  rows_ = static_cast<int>(extent.y() / spacing_) + 1;
  known_vertex_.assign(size(), unknown);
}

Lattice::Known Lattice::look_at(Vertex v) {
  const double clear = field_.lower_bound(at(v));
  const int place = static_cast<int>(v) % columns_ | static_cast<int>(v) / columns_;
  double within = fine_within_;
  for (int step = 2; step <= coarsest && clear >= within; step *= 2, within *= 2) {
    if (place % step != 0) return left_out;
  }
  const double longest_edge = (is_of_walls() ? 1.5 : 1) * spacing_ * std::numbers::sqrt2;
  if (clear >= radius_ + longest_edge) return wide;
  if (field_.is_free(at(v), radius_) || (is_of_walls() && shift_off_wall(v))) return free_;
  return blocked;
}

/// Moves a vertex up the gradient of the clearance until the disc is free there. Returns false if that is too
/// far away.
bool Lattice::shift_off_wall(Vertex v) {
  constexpr int steps_uphill = 4;
  const Point2 place = at(v);
  if (!field_.is_free(place, 0)) return false;
  Point2 p = place;
  for (int k = 0; k < steps_uphill; ++k) {
    const Point2 up = uphill(field_, p, shift_unit());
    if (up.isZero(0)) break;
    p += up * (radius_ + 2 * shift_unit() - field_.clearance(p));
    const Point2 units = (p - place) / shift_unit();
    if (units.cwiseAbs().maxCoeff() > most_shift) break;
    shifts_[v] = {static_cast<std::int8_t>(std::lround(units.x())),
                  static_cast<std::int8_t>(std::lround(units.y()))};
    if (field_.is_free(at(v), radius_)) return true;
  }
  shifts_[v] = {0, 0};
  return false;
}

bool Lattice::edge_free(Vertex v, Vertex w, std::size_t direction) {
  if (known_vertex_[v] == wide || known_vertex_[w] == wide) return true;
  if (direction >= 4) {
    std::swap(v, w);
    direction -= 4;
  }
  if (known_edges_.empty()) known_edges_.assign(size(), 0);
  const auto shift = static_cast<int>(2 * direction);
  auto known = static_cast<Known>((known_edges_[v] >> shift) & 3);  // never wide
  if (known == unknown) {
    known = field_.segment_free(at(v), at(w), radius_) ? free_ : blocked;
    known_edges_[v] |= static_cast<std::uint8_t>(known << shift);
  }
  return known == free_;
}

}  // namespace coppice
