// The beginning of a track in which a robot that began a little too near to an obstacle drove out.
#pragma once

#include <algorithm>
#include <cstddef>

#include "coppice/motion/separation.h"
#include "coppice/planning/clearance_field.h"

namespace coppice {

/// Removes the points up to the first one at which the robot is free of obstacles, or comes closer to one
/// again. True: there is such a point.
inline bool drop_way_out(Track& track, const ClearanceField& field) {
  double before = 0;
  const auto has_left = [&](const TrackPoint& point) {
    const double clearance = field.clearance(point.position);
    const bool comes_closer = clearance < before - overlap_tolerance;
    before = clearance;
    return comes_closer || clearance >= track.radius - overlap_tolerance;
  };
  const auto first = std::ranges::find_if(track.points, has_left);
  const bool is_out = first != track.points.end();
  track.points.erase(track.points.begin(), first);
  return is_out;
}

}  // namespace coppice
