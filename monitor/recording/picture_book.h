// Pictures of a fleet from a recording, in the order of time: the robots, the tracks that they have driven so
// far, their paths and trees.
//
// Fleet times in seconds; metres in the map frame.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "files/picture.h"
#include "monitor/recording/recording.h"
#include "monitor/view/fleet_view.h"

namespace coppice {

class PictureBook {
 public:
  /// `recording` must outlive it. Throws InputError if it contains no fleet.
  explicit PictureBook(const Recording& recording);

  /// Fleet times of the first and the last picture. 0 is when the first run of the recording began.
  double begin() const { return begin_; }
  double end() const { return end_; }

  /// The picture at a time, which must not be before that of the last call. Throws InputError if the file is
  /// damaged.
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
