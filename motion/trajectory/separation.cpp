#include "coppice/motion/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/trajectory/segments.h"

namespace coppice {

namespace {

// Seconds; pairs that are far apart throughout a window are skipped as a whole.
constexpr double window = 1.0;

/// Reads positions of a track at growing times, none before `from`.
class Cursor {
 public:
  explicit Cursor(const Track& track, double from = -std::numeric_limits<double>::infinity())
      : points_(track.points) {
    const auto at =
        std::ranges::partition_point(points_, [&](const TrackPoint& p) { return p.time <= from; });
    next_ = static_cast<std::size_t>(at - points_.begin());
  }

  Point2 at(double time) {
    while (next_ < points_.size() && points_[next_].time <= time) ++next_;
    if (next_ == 0) return points_.front().position;
    if (next_ == points_.size()) return points_.back().position;
    const TrackPoint& a = points_[next_ - 1];
    const TrackPoint& b = points_[next_];
    return a.position + (b.position - a.position) * ((time - a.time) / (b.time - a.time));
  }

  /// The first stamp after `time`; infinity if there is none.
  double stamp_after(double time) const {
    std::size_t i = next_;
    while (i < points_.size() && points_[i].time <= time) ++i;
    return i < points_.size() ? points_[i].time : std::numeric_limits<double>::infinity();
  }

 private:
  const std::vector<TrackPoint>& points_;
  std::size_t next_ = 0;
};

/// For each window of time, a box around the positions of a track.
std::vector<Box<2>> boxes(const Track& track, double begin, std::size_t windows) {
  std::vector<Box<2>> result;
  Cursor cursor(track);
  for (std::size_t w = 0; w < windows; ++w) {
    const double from = begin + static_cast<double>(w) * window;
    Point2 p = cursor.at(from);
    Box<2> box{p, p};
    for (double t = cursor.stamp_after(from); t < from + window; t = cursor.stamp_after(t)) {
      p = cursor.at(t);
      box = extended(box, p);
    }
    Cursor end = cursor;
    p = end.at(from + window);
    result.push_back(extended(box, p));
  }
  return result;
}

double least_distance(const Track& a, const Track& b, double from, double to) {
  Cursor ca(a, from);
  Cursor cb(b, from);
  double t = from;
  Point2 pa = ca.at(t);
  Point2 pb = cb.at(t);
  double least = (pa - pb).norm();
  while (t < to) {
    const double next = std::min({ca.stamp_after(t), cb.stamp_after(t), to});
    const Point2 qa = ca.at(next);
    const Point2 qb = cb.at(next);
    least = std::min(least, closest_approach(pa, qa, pb, qb));
    t = next;
    pa = qa;
    pb = qb;
  }
  return least;
}

}  // namespace

std::optional<Separation> separation_of(std::span<const Track> tracks) {
  std::vector<const Track*> there;
  std::vector<std::size_t> numbers;
  double begin = std::numeric_limits<double>::infinity();
  double end = -begin;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Track& track = tracks[i];
    if (track.points.empty()) continue;
    there.push_back(&track);
    numbers.push_back(i);
    begin = std::min(begin, track.points.front().time);
    end = std::max(end, track.points.back().time);
  }
  if (there.size() < 2) return std::nullopt;

  const auto windows = static_cast<std::size_t>((end - begin) / window) + 1;
  std::vector<std::vector<Box<2>>> covered;
  for (const Track* track : there) covered.push_back(boxes(*track, begin, windows));

  Separation result{std::numeric_limits<double>::infinity(), {}};
  for (std::size_t i = 0; i < there.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double radii = there[i]->radius + there[j]->radius;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t w = 0; w < windows; ++w) {
        // A window is skipped if it can contain neither an overlap nor the least separation.
        const double bound = distance(covered[i][w], covered[j][w]) - radii;
        if (bound > std::min(least, result.least) && bound > 0) continue;
        const double from = begin + static_cast<double>(w) * window;
        const double until = std::min({from + window, there[i]->known_until(), there[j]->known_until()});
        if (until < from) break;
        least = std::min(least, least_distance(*there[i], *there[j], from, until) - radii);
      }
      result.least = std::min(result.least, least);
      if (least < -overlap_tolerance) result.overlapping.emplace(numbers[j], numbers[i]);
    }
  }
  return result;
}

std::optional<ObstacleClearance> clearance_of(std::span<const Track> tracks, const ClearanceField& field) {
  ObstacleClearance result{std::numeric_limits<double>::infinity(), {}};
  bool any = false;
  for (std::size_t number = 0; number < tracks.size(); ++number) {
    const Track& track = tracks[number];
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < track.points.size(); ++i) {
      const Point2& from = track.points[i == 0 ? 0 : i - 1].position;
      const Point2& to = track.points[i].position;
      if (i > 0 && from == to) continue;
      // If the segment cannot come nearer than the least value so far, its bound is enough.
      if (field.lower_bound(from) - (to - from).norm() - track.radius > std::min(least, result.least))
        continue;
      least = std::min(least, field.segment_clearance(from, to) - track.radius);
    }
    if (track.points.empty()) continue;
    any = true;
    result.least = std::min(result.least, least);
    if (least < -overlap_tolerance) result.overlapping.insert(number);
  }
  return any ? std::optional(result) : std::nullopt;
}

Track clipped(const Track& track, double from, double until) {
  Track part{track.radius, {}};
  if (track.points.empty() || track.known_until() < from) return part;
  Cursor cursor(track);
  const auto add_end = [&](double time) {
    if (std::isfinite(time) && time <= track.known_until())
      part.points.push_back({time, cursor.at(time), Point2::Zero()});
  };
  add_end(from);
  for (const TrackPoint& point : track.points) {
    if (point.time > from && point.time < until) part.points.push_back(point);
  }
  add_end(until);
  return part;
}

}  // namespace coppice
