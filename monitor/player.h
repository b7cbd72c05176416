// Plays a recording to a monitor: which of its messages are due by now, as pages wish it to be played.
//
// A state machine: `now` is the present wall clock; the times of the recording are its own.
#pragma once

#include <optional>
#include <vector>

#include "live.pb.h"
#include "monitor/recording.h"

namespace coppice {

class Player {
 public:
  /// From the recording's beginning, which outlives it, at its own speed.
  Player(const Recording& recording, WallTime now);

  /// True: it goes on elsewhere, so that all that was played before is to be forgotten.
  bool heed(const live::FromPage& wish, WallTime now);
  /// What has become due since the last call. Throws InputError where the file is damaged.
  std::vector<Arrival> due(WallTime now);

  /// Where it is, by the recording's clock.
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
  WallTime from_ = 0;   ///< of the recording: it was there
  WallTime since_ = 0;  ///< at this present time
};

}  // namespace coppice
