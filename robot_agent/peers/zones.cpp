#include "robot_agent/peers/zones.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "messages/clock_offset.h"
#include "motion/body/promise.h"
#include "motion/trajectory/segments.h"
#include "planning/quantities.h"
#include "robot_agent/limits.h"
#include "robot_agent/timing.h"

namespace coppice {

namespace {

constexpr double rests_clear =
    0.9;  // of the radius, to the next obstacle: the robot may have turned a little
constexpr double rests_radii = 0.1;  // radii between two positions
constexpr int halvings = 6;          // of that distance, where somebody else stands in between
constexpr double most_rests = 1e6;   // of one robot, whatever it says of its size and speed

/// The last possible position on the way to one that is impossible.
template <class Possible>
Point2 last_possible(Point2 position, Point2 impossible, Possible&& possible) {
  for (int k = 0; k < halvings; ++k) {
    const Point2 middle = (position + impossible) / 2;
    (possible(middle) ? position : impossible) = middle;
  }
  return position;
}

}  // namespace

Zone zone_after(const RobotState& s, double heard_at, int unheard, const ClearanceField& field) {
  const double furthest = s.max_speed * (unheard * control_period + longest_braking);
  const double step = std::max(rests_radii * s.radius, furthest / most_rests);
  std::vector<Point2> rests = rests_after(s.promise, limits_of(s), control_period, unheard, step);
  const auto possible = [&](const Point2& q) { return field.is_free(q, rests_clear * s.radius); };
  const auto end = std::find_if_not(rests.begin() + 1, rests.end(), possible);
  if (end != rests.end()) {
    *end = last_possible(*(end - 1), *end, possible);
    rests.erase(end + 1, rests.end());
  }
  const double moves_for = (2 + unheard) * control_period + braking_time(limits_of(s));
  return {std::move(rests), heard_at + (1 + clock_drift) * moves_for};
}

void prune(Zone& zone, double radius, const RoomAt& room_at) {
  const std::vector<Point2>& rests = zone.rests;
  if (rests.size() < 2) return;
  const auto possible = [&](const Point2& rest) { return room_at(rest) >= radius; };
  std::vector<Point2> left{rests.front()};
  bool was_possible = possible(rests.front());
  for (std::size_t k = 1; k < rests.size(); ++k) {
    const bool is_possible = possible(rests[k]);
    if (was_possible && !is_possible) left.push_back(last_possible(rests[k - 1], rests[k], possible));
    // The first position stays anyway, and covers what is between.
    if (!was_possible && is_possible && k > 1)
      left.push_back(last_possible(rests[k], rests[k - 1], possible));
    if (is_possible) left.push_back(rests[k]);
    was_possible = is_possible;
  }
  zone.rests = std::move(left);
}

double covering_radius(const Zone& zone, double radius, double own_radius) {
  if (zone.rests.size() < 2) return radius;
  const double reach = own_radius + radius;
  return radius + std::hypot(reach, rests_radii * radius / 2) - reach;
}

}  // namespace coppice
