#include "motion/trajectory/earliest_along.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "motion/trajectory/corner_speed.h"

namespace coppice {

namespace {

/// The earliest arrival in a safe interval of a point of the path.
struct Arrival {
  double time;
  double safe_until;
  std::size_t from = 0;  ///< number of the arrival at the point before
};

/// The earliest arrival at b in a safe interval of b, from one of the arrivals at a.
Arrival earliest_in(const Interval& safe, const Point2& a, const Point2& b,
                    const std::vector<Arrival>& arrivals, double lost, SpaceTime& others,
                    const Limits& limits) {
  const double duration = (b - a).norm() / limits.max_speed;
  Arrival best{SpaceTime::forever, safe.end};
  for (std::size_t from = 0; from < arrivals.size(); ++from) {
    const double ready = arrivals[from].time + lost;
    const double first = std::max(ready, safe.begin - duration);
    if (first > arrivals[from].safe_until || first + duration >= best.time) continue;
    const double departure = others.first_departure(a, b, ready, first, limits);
    const double arrival = departure + duration;
    if (departure > arrivals[from].safe_until || arrival >= std::min(safe.end, best.time)) continue;
    best.time = arrival;
    best.from = from;
  }
  return best;
}

}  // namespace

std::optional<Trajectory> earliest_along(const Path& path, SpaceTime& others, double begin, double stray,
                                         const Limits& limits, double stays) {
  std::vector<std::vector<Arrival>> arrivals(path.size());
  for (const Interval& safe : others.safe_at(path.front())) {
    if (safe.begin <= begin && begin < safe.end) arrivals.front().push_back({begin, safe.end});
  }
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double lost = time_lost_at(path, k - 1, stray, limits);
    for (const Interval& safe : others.safe_at(path[k])) {
      const Arrival arrival = earliest_in(safe, path[k - 1], path[k], arrivals[k - 1], lost, others, limits);
      if (arrival.time < SpaceTime::forever) arrivals[k].push_back(arrival);
    }
  }
  const auto last = std::ranges::find_if(
      arrivals.back(), [&](const Arrival& arrival) { return arrival.safe_until >= arrival.time + stays; });
  if (last == arrivals.back().end()) return std::nullopt;
  const Arrival* at = &*last;
  Trajectory back{{at->time, path.back()}};
  for (std::size_t k = path.size() - 1; k > 0; --k) {
    const double departure = at->time - (path[k] - path[k - 1]).norm() / limits.max_speed;
    at = &arrivals[k - 1][at->from];
    constexpr double rounding = 1e-9;
    if (departure > at->time + rounding) back.push_back({departure, path[k - 1]});
    back.push_back({at->time, path[k - 1]});
  }
  std::ranges::reverse(back);
  return back;
}

}  // namespace coppice
