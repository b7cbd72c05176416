#include "motion/trajectory/corners.h"

#include <cmath>

namespace coppice {

/// The point at which the jump begins is as far from both edges as the robot may stray.
std::vector<Corner> corners_of(const Path& way, double stray) {
  constexpr double rounding = 1e-9;
  std::vector<Corner> corners;
  double along = 0;
  for (std::size_t k = 1; k + 1 < way.size(); ++k) {
    const Point2 in = way[k] - way[k - 1];
    const Point2 out = way[k + 1] - way[k];
    along += in.norm();
    if (in.dot(out) <= 0) continue;
    const double bend = std::atan2(std::abs(in.x() * out.y() - in.y() * out.x()), in.dot(out));
    const double jump = 2 * stray * std::tan(bend / 2);
    if (jump > rounding) corners.push_back({along, jump});
  }
  return corners;
}

double gained_at(std::span<const Corner> corners, double from, double to) {
  if (to <= from) return 0;
  double gained = 0;
  for (const Corner& corner : corners) {
    // What was gained before may have led to the next corner.
    if (corner.at >= from - corner.jump / 2 && corner.at <= to + gained + corner.jump / 2)
      gained += corner.jump;
  }
  return gained;
}

}  // namespace coppice
