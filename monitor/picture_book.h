// Pictures of a fleet out of a recording, in the order of time: where everybody is, what they have driven
// until then, their ways and trees.
//
// Fleet time in seconds; metres in the map frame.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "files/picture.h"
#include "monitor/fleet_view.h"
#include "monitor/recording.h"

namespace coppice {

class PictureBook {
 public:
  /// `recording` outlives it. Throws InputError if no fleet is in it.
  explicit PictureBook(const Recording& recording);

  /// Fleet times of the first picture, and of the last: 0 is when the first run of the recording began.
  double begin() const { return begin_; }
  double end() const { return end_; }

  /// As of a time, not before the one that was asked for last. Throws InputError where the file is damaged.
  PictureContent at(double time);

 private:
  void take(const Arrival& arrival);
  PictureContent::Robot drawn(const SeenRobot& seen, double time) const;

  Playback playback_;
  std::optional<Arrival> next_;
  FleetClock clock_;  ///< of the recording's first run
  FleetView view_;
  std::uint32_t run_ = 0;
  std::map<RobotName, Path> driven_;
  double begin_ = 0;
  double end_ = 0;
};

}  // namespace coppice
