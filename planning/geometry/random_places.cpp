#include "planning/geometry/random_places.h"

#include <algorithm>

namespace coppice {

namespace {

constexpr int most_draws = 1000;  // draws before all positions are examined

bool is_taken(const Point2& p, std::span<const KeepOut> taken) {
  return std::ranges::any_of(taken, [&](const KeepOut& t) { return (t.centre - p).norm() < t.distance; });
}

}  // namespace

std::optional<Point2> draw_place(const ReachablePart& part, const Point2& from, double least_way,
                                 std::span<const KeepOut> taken, Random& random) {
  if (part.empty()) return std::nullopt;
  for (int draw = 0; draw < most_draws; ++draw) {
    const Point2 p = part.place(random.index(part.size()));
    if (p != from && (p - from).norm() >= least_way && !is_taken(p, taken)) return p;
  }
  std::vector<Point2> free;
  double furthest = 0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    const Point2 p = part.place(k);
    if (p == from || is_taken(p, taken)) continue;
    free.push_back(p);
    furthest = std::max(furthest, (p - from).norm());
  }
  if (free.empty()) return std::nullopt;
  while (least_way > furthest) least_way /= 2;
  std::erase_if(free, [&](const Point2& p) { return (p - from).norm() < least_way; });
  return free[random.index(free.size())];
}

bool SpacedPlaces::has_room(const Point2& p) const {
  bool room = true;
  grid_.for_each_near(p, [&](NodeId, const Point2& other) { room &= (other - p).norm() >= distance_; });
  return room;
}

std::vector<Point2> packed_places(const ReachablePart& part, double distance) {
  std::vector<Point2> packed;
  if (part.empty()) return packed;
  SpacedPlaces spaced(part.box(), distance);
  for (std::size_t k = 0; k < part.size(); ++k) {
    const Point2 p = part.place(k);
    if (!spaced.has_room(p)) continue;
    spaced.add(p);
    packed.push_back(p);
  }
  return packed;
}

}  // namespace coppice
