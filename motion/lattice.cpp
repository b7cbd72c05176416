#include "motion/lattice.h"

#include <utility>

namespace coppice {

namespace {

/// The largest multiple of half a cell that is at most `wanted`; at least half a cell.
double on_half_cells(double wanted, double resolution) {
  const double half = resolution / 2;
  return half * std::max(1.0, std::floor(wanted / half));
}

}  // namespace

Lattice::Lattice(const ClearanceField& field, double radius, double spacing)
    : field_(field), radius_(radius), spacing_(on_half_cells(spacing, field.frame().resolution)) {
  const Box<2> box = field.bounds();
  origin_ = box.lower;
  columns_ = static_cast<int>((box.upper.x() - box.lower.x()) / spacing_) + 1;
  rows_ = static_cast<int>((box.upper.y() - box.lower.y()) / spacing_) + 1;
  known_vertex_.assign(size(), unknown);
}

Lattice::Known Lattice::look_at(Vertex v) const {
  if (field_.lower_bound(at(v)) >= radius_ + spacing_ * std::numbers::sqrt2) return wide;
  return field_.is_free(at(v), radius_) ? free_ : blocked;
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
