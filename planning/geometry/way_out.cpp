#include "planning/geometry/way_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace coppice {

namespace {

constexpr int pieces = 16;         // of a way that are compared
constexpr double rounding = 1e-9;  // metres of clearance
constexpr int directions = 64;
// Lengths of the way, in overlaps: away from one wall, and out of a corner.
constexpr std::array lengths{1.0, 1.1, 1.25, 1.5, 2.0, 3.0};
constexpr double beyond = 1e-6;  // metres, so that the place is free in spite of rounding

}  // namespace

bool leads_out(const ClearanceField& field, const Point2& a, const Point2& b, double radius) {
  double before = field.clearance(a);
  for (int k = 1; k <= pieces; ++k) {
    const double clearance = field.clearance(a + static_cast<double>(k) / pieces * (b - a));
    if (clearance < std::min(radius, before) - rounding) return false;
    before = clearance;
  }
  return true;
}

std::optional<Point2> way_out(const ClearanceField& field, const Point2& p, double radius,
                              double most_overlap) {
  if (field.is_free(p, radius)) return p;
  const double overlap = radius - field.clearance(p);
  if (!(overlap < most_overlap && overlap < radius)) return std::nullopt;
  std::optional<Point2> best;
  double roomiest = 0;
  for (const double length : lengths) {
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * std::numbers::pi * k / directions;
      const Point2 q = p + (length * overlap + beyond) * Point2(std::cos(angle), std::sin(angle));
      const double clearance = field.clearance(q);
      if (clearance <= roomiest || !field.is_free(q, radius) || !leads_out(field, p, q, radius)) continue;
      roomiest = clearance;
      best = q;
    }
    if (best) return best;
  }
  return std::nullopt;
}

}  // namespace coppice
