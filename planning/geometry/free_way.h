// Whether a disc may move straight on from its position.
#pragma once

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"

namespace coppice {

/// Metres by which rounding may drive a disc into an obstacle in a whole run, with a margin.
inline constexpr double driving_rounding = 1e-7;

/// Whether a disc of `radius` (metres) at `from` may move straight to `to` without overlapping an obstacle. A
/// disc that rounding has brought into an obstacle by less than `driving_rounding` may move as long as it
/// comes no nearer; otherwise it could never leave.
inline bool way_free(const ClearanceField& field, const Point2& from, const Point2& to, double radius) {
  if (field.segment_free(from, to, radius)) return true;
  constexpr double no_nearer = 1e-12;
  const double here = field.clearance(from);
  if (here >= radius || here < radius - driving_rounding) return false;
  return field.segment_free(from, to, here - no_nearer);
}

}  // namespace coppice
