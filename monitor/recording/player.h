// Plays a recording to a monitor, as pages wish: returns the messages that are due.
//
// A state machine: `now` is the present wall clock. The recording has its own times.
#pragma once

#include <optional>
#include <vector>

#include "live.pb.h"
#include "monitor/recording/recording.h"

namespace coppice {

class Player {
 public:
  /// Plays from the beginning of the recording, which must outlive it, at normal speed.
  Player(const Recording& recording, WallTime now);

  /// True if playback continues at another time, so that all that was played before must be forgotten.
  bool heed(const live::FromPage& wish, WallTime now);
  /// Returns the messages that are due since the last call. Throws InputError if the file is damaged.
  std::vector<Arrival> due(WallTime now);

  /// The current position, in the recording's time.
  WallTime at(WallTime now) const;
  live::Playback state(WallTime now) const;

 private:
  void go_on(WallTime at, WallTime now);
  bool jump(WallTime to, WallTime now);

  const Recording* recording_;
  Playback playback_;
  std::optional<Arrival> next_;
  bool playing_ = true;
  double speed_ = 1;
  WallTime from_ = 0;   ///< position in the recording
  WallTime since_ = 0;  ///< the present time at which it was there
};

}  // namespace coppice
