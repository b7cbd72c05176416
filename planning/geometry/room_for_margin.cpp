#include "planning/geometry/room_for_margin.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace coppice {

namespace {

/// Points of the map, between which discs move along the axes.
class Lattice {
 public:
  /// The middle of a passage along an axis is at a multiple of half a cell.
  explicit Lattice(const ClearanceField& field)
      : origin_(field.bounds().lower), spacing_(field.frame().resolution / 2) {
    const Point2 size = (field.bounds().upper - origin_) / spacing_;
    columns_ = static_cast<std::ptrdiff_t>(std::round(size.x())) + 1;
    rows_ = static_cast<std::ptrdiff_t>(std::round(size.y())) + 1;
  }

  double spacing() const { return spacing_; }
  std::ptrdiff_t columns() const { return columns_; }
  std::ptrdiff_t rows() const { return rows_; }
  std::size_t size() const { return static_cast<std::size_t>(columns_ * rows_); }
  std::size_t index(std::ptrdiff_t i, std::ptrdiff_t j) const {
    return static_cast<std::size_t>(j * columns_ + i);
  }
  Point2 at(std::size_t k) const {
    const auto [i, j] = steps(k);
    return origin_ + spacing_ * Point2(static_cast<double>(i), static_cast<double>(j));
  }
  std::pair<std::ptrdiff_t, std::ptrdiff_t> steps(std::size_t k) const {
    return {static_cast<std::ptrdiff_t>(k) % columns_, static_cast<std::ptrdiff_t>(k) / columns_};
  }

  /// Calls fn(index) for the points within so many steps of a point, along both axes.
  template <class Fn>
  void for_each_near(std::size_t k, std::ptrdiff_t reach, Fn&& fn) const {
    const auto [i, j] = steps(k);
    for (std::ptrdiff_t y = std::max<std::ptrdiff_t>(0, j - reach); y <= std::min(rows_ - 1, j + reach); ++y)
      for (std::ptrdiff_t x = std::max<std::ptrdiff_t>(0, i - reach); x <= std::min(columns_ - 1, i + reach);
           ++x)
        fn(index(x, y));
  }

  std::size_t nearest(const Point2& p) const {
    const Point2 q = ((p - origin_) / spacing_).array().round();
    return index(std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(q.x()), 0, columns_ - 1),
                 std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(q.y()), 0, rows_ - 1));
  }

 private:
  Point2 origin_;
  double spacing_;
  std::ptrdiff_t columns_;
  std::ptrdiff_t rows_;
};

using FreePoints = std::vector<std::uint8_t>;  ///< by point of the lattice: 1 where the disc fits

/// Moves the part that holds `seed` from one space to another. False if there is none.
bool move_part(const Lattice& lattice, std::size_t seed, FreePoints& from, FreePoints& to) {
  if (from[seed] == 0) return false;
  std::vector<std::size_t> frontier;
  const auto take = [&](std::size_t k) {
    if (from[k] == 0) return;
    from[k] = 0;
    to[k] = 1;
    frontier.push_back(k);
  };
  take(seed);
  while (!frontier.empty()) {
    const std::size_t k = frontier.back();
    frontier.pop_back();
    const auto [i, j] = lattice.steps(k);
    if (i > 0) take(lattice.index(i - 1, j));
    if (j > 0) take(lattice.index(i, j - 1));
    if (i + 1 < lattice.columns()) take(lattice.index(i + 1, j));
    if (j + 1 < lattice.rows()) take(lattice.index(i, j + 1));
  }
  return true;
}

/// The part of a space in which a larger disc fits.
FreePoints part_of(FreePoints space, const Lattice& lattice, const ClearanceField& field, double radius) {
  for (std::size_t k = 0; k < space.size(); ++k) {
    if (space[k] != 0 && !field.is_free(lattice.at(k), radius)) space[k] = 0;
  }
  return space;
}

std::size_t parts_of(const Lattice& lattice, FreePoints space) {
  FreePoints seen(space.size(), 0);
  std::size_t parts = 0;
  for (std::size_t k = 0; k < space.size(); ++k) parts += move_part(lattice, k, space, seen) ? 1 : 0;
  return parts;
}

/// Points minus edges plus squares.
std::ptrdiff_t euler_characteristic(const Lattice& lattice, const FreePoints& space) {
  std::ptrdiff_t sum = 0;
  const auto at = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
    return i < lattice.columns() && j < lattice.rows() && space[lattice.index(i, j)] != 0;
  };
  for (std::ptrdiff_t j = 0; j < lattice.rows(); ++j) {
    for (std::ptrdiff_t i = 0; i < lattice.columns(); ++i) {
      if (!at(i, j)) continue;
      const bool right = at(i + 1, j);
      const bool above = at(i, j + 1);
      sum += 1 - (right ? 1 : 0) - (above ? 1 : 0) + (right && above && at(i + 1, j + 1) ? 1 : 0);
    }
  }
  return sum;
}

/// Whether each point of a space is within some steps of the smaller space.
bool covers(const Lattice& lattice, const FreePoints& smaller, const FreePoints& space,
            std::ptrdiff_t steps) {
  for (std::size_t k = 0; k < space.size(); ++k) {
    if (space[k] == smaller[k]) continue;
    bool is_near = false;
    lattice.for_each_near(k, steps, [&](std::size_t near) { is_near = is_near || smaller[near] != 0; });
    if (!is_near) return false;
  }
  return true;
}

}  // namespace

bool leaves_all_passages(const ClearanceField& field, double radius, double margin,
                         std::span<const Point2> places) {
  const Lattice lattice(field);
  FreePoints unreached = part_of(FreePoints(lattice.size(), 1), lattice, field, radius);
  FreePoints reached(lattice.size(), 0);
  for (const Point2& place : places) {
    lattice.for_each_near(lattice.nearest(place), 1,
                          [&](std::size_t k) { move_part(lattice, k, unreached, reached); });
  }
  const FreePoints smaller = part_of(reached, lattice, field, radius + margin);
  const auto rim = static_cast<std::ptrdiff_t>(std::ceil(2 * margin / lattice.spacing())) + 1;
  return euler_characteristic(lattice, reached) == euler_characteristic(lattice, smaller) &&
         parts_of(lattice, reached) == parts_of(lattice, smaller) && covers(lattice, smaller, reached, rim);
}

}  // namespace coppice
