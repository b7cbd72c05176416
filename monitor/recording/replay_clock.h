// Converts a recording's wall clock to the present one while it is replayed.
#pragma once

#include "messages/fleet_clock.h"
#include "messages/messages.h"

namespace coppice {

struct ReplayClock {
  WallTime from = 0;   ///< this time of the recording
  WallTime start = 0;  ///< is replayed at this present time
  double speed = 1;    ///< recorded seconds per second, above 0

  WallTime present(WallTime recorded) const { return start + (recorded - from) / speed; }
};

/// Converts a message to the present. The fleet's clock gives at present(t) the fleet time that it gave at t,
/// and totals of processor time grow as fast as recorded. Fleet times and durations do not change.
Message at_present(Message message, const ReplayClock& clock);

}  // namespace coppice
