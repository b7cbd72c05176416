#include "motion/body/keep_right.h"

#include <algorithm>

namespace coppice {

namespace {

// Metres to the right for each metre ahead. Without it no circle of ten robots gets through by reciprocal
// velocity obstacles alone; far more leads robots against walls.
constexpr double to_the_right = 0.2;

}  // namespace

Point2 keeping_right(const Point2& preferred, const Point2& position, std::span<const Neighbour> neighbours) {
  const bool meets_one = std::ranges::any_of(neighbours, [&](const Neighbour& n) {
    return (n.promise.position - position).dot(preferred) > 0 && n.promise.next_velocity.dot(preferred) < 0;
  });
  return meets_one ? Point2(preferred + to_the_right * Point2(preferred.y(), -preferred.x())) : preferred;
}

}  // namespace coppice
