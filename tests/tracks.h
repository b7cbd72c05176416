// Puts tracks together that are read in parts.
#pragma once

#include <vector>

#include "files/track_record.h"

namespace coppice::test {

/// Each robot's points, once.
inline std::vector<std::vector<TrackPoint>> all_points(const TrackParts& parts) {
  std::vector<std::vector<TrackPoint>> all;
  parts([&](const TrackPart& part) {
    all.resize(part.tracks.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (const TrackPoint& point : part.tracks[i].track.points) {
        if (part.holds(point)) all[i].push_back(point);
      }
    }
  });
  return all;
}

}  // namespace coppice::test
