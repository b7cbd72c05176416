#include "motion/trajectory/wide_corners.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "motion/trajectory/corner_speed.h"

namespace coppice {

namespace {

constexpr double least_bend = 0.05;                   // radians: less costs hardly any time
constexpr double most_bend = 2.5;                     // radians
constexpr double least_saving = control_period / 10;  // seconds: less than control can keep to
constexpr int radii = 5;  // arcs that are tried, each of half the radius of the one before

/// Seconds for the path at full speed, and what the robot loses at corners.
double time_along(const Path& path, double stray, const Limits& limits) {
  double seconds = length_of(path) / limits.max_speed;
  for (std::size_t k = 1; k + 1 < path.size(); ++k) seconds += time_lost_at(path, k, stray, limits);
  return seconds;
}

/// The smallest arc that a robot drives at full speed.
double full_speed_radius(double stray, const Limits& limits) {
  const double squared = limits.max_speed * limits.max_speed;
  const double braking = squared / (2 * limits.max_acceleration);
  if (is_differential(limits))
    return std::max({squared / sideways_acceleration(limits), limits.max_speed / limits.max_angular_speed,
                     braking * braking / (2 * stray)});
  return std::max(squared / limits.max_acceleration, braking * braking / (2 * stray));
}

/// The bends around an arc that touches a corner from outside. Each touches the arc between two of its edges.
Path bends_around(const Point2& before, const Point2& corner, const Point2& after, double radius,
                  double stray) {
  const Point2 in = (corner - before).normalized();
  const Point2 out = (after - corner).normalized();
  const double bend = std::acos(std::clamp(in.dot(out), -1.0, 1.0));
  if (bend < least_bend || bend > most_bend) return {};
  const double at_once = 2 * std::acos(1 / (1 + stray / radius));
  const double count = std::max(2.0, std::ceil(bend / at_once));
  const Point2 inwards = (out - in).normalized();
  const Point2 along = (in + out).normalized();
  const double reach = radius / std::cos(bend / (2 * count));
  Path bends;
  for (double k = 0.5; k < count; ++k) {
    const double angle = bend * (k / count - 0.5);
    bends.push_back(corner + radius * inwards +
                    reach * (std::sin(angle) * along - std::cos(angle) * inwards));
  }
  return bends;
}

bool is_free(const Path& path, const ClearanceField& field, double clearance) {
  for (std::size_t k = 1; k < path.size(); ++k) {
    if (!field.segment_free(path[k - 1], path[k], clearance)) return false;
  }
  return true;
}

/// The bends that take the least time in place of corner i; the corner itself if no others save enough;
/// none if the edge without the corner takes the least.
/// `before`: the new path until there, of which the last two points count: the corners before and after bend
/// more or less then.
Path best_bends(std::span<const Point2> before, const Path& path, std::size_t i, const ClearanceField& field,
                double clearance, double stray, const Limits& limits) {
  const auto with = [&](const Path& bends) {
    Path tried(before.end() - static_cast<std::ptrdiff_t>(std::min<std::size_t>(before.size(), 2)),
               before.end());
    tried.insert(tried.end(), bends.begin(), bends.end());
    const auto after = path.begin() + static_cast<std::ptrdiff_t>(i + 1);
    tried.insert(tried.end(), after, std::min(after + 2, path.end()));
    return tried;
  };
  Path best{path[i]};
  double least = time_along(with(best), stray, limits) - least_saving;
  const auto consider = [&](const Path& bends) {
    const Path tried = with(bends);
    const double time = time_along(tried, stray, limits);
    if (time >= least || !is_free(tried, field, clearance)) return;
    least = time;
    best = bends;
  };
  consider({});
  double radius = full_speed_radius(stray, limits);
  for (int k = 0; k < radii; ++k, radius /= 2) {
    // On a narrower arc the jumps at its bends would add up (corners.h).
    if (radius < stray) break;
    const Path bends = bends_around(before.back(), path[i], path[i + 1], radius, stray);
    if (bends.empty()) break;
    consider(bends);
  }
  return best;
}

}  // namespace

Path with_wide_corners(const Path& path, const ClearanceField& field, double clearance, double stray,
                       const Limits& limits) {
  Path wide{path.front()};
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Path bends = best_bends(wide, path, i, field, clearance, stray, limits);
    wide.insert(wide.end(), bends.begin(), bends.end());
  }
  wide.push_back(path.back());
  return wide;
}

}  // namespace coppice
