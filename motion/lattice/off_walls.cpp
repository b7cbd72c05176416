#include "motion/lattice/off_walls.h"

#include <cstddef>
#include <optional>

namespace coppice {

namespace {

/// A point near p that keeps `roomy` from obstacles; none: p does, or there is none uphill.
std::optional<Point2> with_room(const Point2& p, const ClearanceField& field, double roomy) {
  constexpr int steps_uphill = 4;
  constexpr double slight = 0.001;  // of the clearance: rounding, and the distance at which slopes are taken
  Point2 moved = p;
  for (int k = 0; k < steps_uphill && !field.is_free(moved, roomy); ++k)
    moved += uphill(field, moved, slight * roomy) * ((1 + slight) * roomy - field.clearance(moved));
  return moved != p && field.is_free(moved, roomy) ? std::optional(moved) : std::nullopt;
}

}  // namespace

Point2 uphill(const ClearanceField& field, const Point2& p, double near) {
  const auto slope = [&](const Point2& d) { return field.clearance(p + d) - field.clearance(p - d); };
  const Point2 up(slope({near, 0}), slope({0, near}));
  return up.isZero(0) ? up : Point2(up.normalized());
}

Path off_walls(const Path& path, const ClearanceField& field, double radius, double roomy) {
  Path moved = path;
  for (std::size_t k = 1; k + 1 < path.size(); ++k) {
    const auto corner = with_room(path[k], field, roomy);
    if (corner && field.segment_free(moved[k - 1], *corner, radius) &&
        field.segment_free(*corner, path[k + 1], radius))
      moved[k] = *corner;
  }
  return moved;
}

}  // namespace coppice
