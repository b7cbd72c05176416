// The interface of a space for planners: bounds, and whether a ball of some radius is free. Metres.
#pragma once

#include <concepts>

#include "coppice/planning/geometry.h"

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
