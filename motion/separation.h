// Least separation and clearance of recorded tracks, exact in continuous time.
//
// Positions are linear between a track's points; a robot stands before its first and after its last point.
// Metres, seconds.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "planning/clearance_field.h"
#include "planning/geometry.h"

namespace coppice {

struct TrackPoint {
  double time = 0;
  Point2 position = Point2::Zero();
  Point2 velocity = Point2::Zero();
};

struct Track {
  double radius = 0;
  std::vector<TrackPoint> points;  ///< times grow
};

/// Overlaps up to this are the arithmetic's, not the robots'.
inline constexpr double overlap_tolerance = 1e-6;

struct Separation {
  double least = 0;             ///< over time and pairs: distance minus both radii
  std::size_t overlapping = 0;  ///< pairs that overlapped by more than the tolerance
};

/// Nothing for fewer than two tracks with points.
std::optional<Separation> separation_of(std::span<const Track> tracks);

struct ObstacleClearance {
  double least = 0;             ///< over time and robots: clearance minus the radius
  std::size_t overlapping = 0;  ///< robots that overlapped an obstacle by more than the tolerance
};

/// Nothing if no track has points.
std::optional<ObstacleClearance> clearance_of(std::span<const Track> tracks, const ClearanceField& field);

}  // namespace coppice
