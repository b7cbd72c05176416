// Least separation and clearance of recorded tracks, exact in continuous time.
//
// Positions are linear between a track's points. A robot stands before its first point. After its last point
// it stands if it stood there; else nobody knows where it is, and it counts for nothing. Metres, seconds.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "coppice/planning/clearance_field.h"
#include "coppice/planning/geometry.h"

namespace coppice {

struct TrackPoint {
  double time = 0;
  Point2 position = Point2::Zero();
  Point2 velocity = Point2::Zero();
  double yaw = 0;               ///< radians; of a differential robot, like the next one
  double angular_velocity = 0;  ///< radians a second
};

struct Track {
  double radius = 0;
  std::vector<TrackPoint> points;  ///< times grow

  /// Until when it says where the robot is; infinity: for ever. Only if it has points.
  double known_until() const {
    const TrackPoint& last = points.back();
    return last.velocity.isZero(0) ? std::numeric_limits<double>::infinity() : last.time;
  }
};

/// Metres. Smaller overlaps are due to rounding.
inline constexpr double overlap_tolerance = 1e-6;

struct Separation {
  double least = 0;  ///< metres; over time and pairs: distance minus both radii
  /// Pairs that overlapped by more than the tolerance.
  std::set<std::pair<std::size_t, std::size_t>> overlapping;
};

/// Nothing for fewer than two tracks with points.
std::optional<Separation> separation_of(std::span<const Track> tracks);

struct ObstacleClearance {
  double least = 0;                   ///< metres; over time and robots: clearance minus the radius
  std::set<std::size_t> overlapping;  ///< robots that overlapped an obstacle by more than the tolerance
};

/// Nothing if no track has points.
std::optional<ObstacleClearance> clearance_of(std::span<const Track> tracks, const ClearanceField& field);

/// The part of a track from one time until another; either may be infinite. Empty if the track has no points.
Track clipped(const Track& track, double from, double until);

/// Combines the results of parts in time: adds `part` to `whole`.
template <class Contact>
void add_part(std::optional<Contact>& whole, std::optional<Contact> part) {
  if (!whole || !part) {
    if (part) whole = std::move(part);
    return;
  }
  whole->least = std::min(whole->least, part->least);
  whole->overlapping.merge(part->overlapping);
}

}  // namespace coppice
