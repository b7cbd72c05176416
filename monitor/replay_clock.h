// A recording's wall clock, as it goes when the recording is replayed.
#pragma once

#include "messages/fleet_clock.h"
#include "messages/messages.h"

namespace coppice {

struct ReplayClock {
  WallTime from = 0;   ///< of the recording: is replayed at
  WallTime start = 0;  ///< by the present clock
  double speed = 1;    ///< recorded seconds a second, above 0

  WallTime present(WallTime recorded) const { return start + (recorded - from) / speed; }
};

/// The message as it would be said now: the fleet's clock gives at present(t) the fleet time that it gave at
/// t, and totals of processor time grow as fast as they did. Fleet time itself and durations stay.
Message at_present(Message message, const ReplayClock& clock);

}  // namespace coppice
