// What a planner asks of the space that it plans in: bounds, and whether a ball of some radius fits.
#pragma once

#include <concepts>

#include "planning/geometry.h"

namespace coppice {

template <class S>
concept Space = requires(const S& space, const Point<S::dimension>& p, double radius) {
  { space.bounds() } -> std::convertible_to<Box<S::dimension>>;
  /// Whether a ball of `radius` at p overlaps nothing.
  { space.is_free(p, radius) } -> std::same_as<bool>;
  /// Whether a ball of `radius` that moves straight from a to b overlaps nothing on its way.
  { space.segment_free(p, p, radius) } -> std::same_as<bool>;
};

}  // namespace coppice
