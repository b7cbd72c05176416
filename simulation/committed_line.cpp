#include "simulation/committed_line.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr double same_moment = 1e-9;  // seconds: rounding

}  // namespace

CommittedLine::Place CommittedLine::place(double time) const {
  const double periods = std::max(0.0, (time - begin) / period);
  const auto last = static_cast<double>(points.size() - 1);
  if (periods >= last) return {points.size() - 1, 0};
  const double whole = std::floor(periods);
  return {static_cast<std::size_t>(whole), periods - whole};
}

Point2 CommittedLine::at(double time) const {
  const auto [point, share] = place(time);
  if (point + 1 == points.size()) return points.back();
  return points[point] + share * (points[point + 1] - points[point]);
}

double CommittedLine::length_after(double time) const {
  const auto [point, share] = place(time);
  double length = 0;
  Point2 here = at(time);
  for (std::size_t k = point + 1; k < points.size(); ++k) {
    length += (points[k] - here).norm();
    here = points[k];
  }
  return length;
}

/// From the second period on the body brakes.
double CommittedLine::fastest_after(double time) const {
  const std::size_t from = place(time).point;
  double longest = 0;
  for (std::size_t k = from; k < std::min(from + 2, points.size() - 1); ++k)
    longest = std::max(longest, (points[k + 1] - points[k]).squaredNorm());
  return std::sqrt(longest) / period;
}

double CommittedLine::next_point_after(double time) const {
  if (time < begin - same_moment) return begin;
  const std::size_t point = place(time + same_moment).point;
  return point + 1 == points.size() ? never : begin + period * static_cast<double>(point + 1);
}

void commit(const Driver& body, const AgentClock& clock, CommittedLine& line) {
  line.begin = clock.true_time(body.time());
  line.period = body.period() / (1 + clock.drift);
  line.points.assign(1, body.position());
  for (Driver driven = body; !driven.stands();) {
    driven.advance();
    line.points.push_back(driven.position());
  }
}

/// Passes as much time at once as the two need for the gap between them at full speed. Where that is less
/// than a period, the gap is computed exactly.
std::optional<double> first_closer(const CommittedLine& a, const CommittedLine& b, double distance,
                                   double from) {
  const double end = std::max(a.end(), b.end());
  double time = from;
  for (;;) {
    const Point2 in_a = a.at(time);
    const Point2 in_b = b.at(time);
    const double gap = (in_a - in_b).norm() - distance;
    if (gap < 0) return time;
    if (time >= end) return std::nullopt;
    const double next = std::min({a.next_point_after(time), b.next_point_after(time), end});
    const double far = time + gap / (a.fastest_after(time) + b.fastest_after(time));
    if (!(far >= next) && closest_approach(in_a, a.at(next), in_b, b.at(next)) < distance) return time;
    time = std::max(next, std::min(far, end));
  }
}

}  // namespace coppice
