// Fleet time: seconds since the run began, possibly faster or slower than the wall's clock.
#pragma once

#include "messages/run_id.h"

namespace coppice {

struct FleetClock {
  WallTime epoch = 0;  ///< when fleet time was 0
  double scale = 1;    ///< fleet seconds a wall second, above 0

  RunId run() const { return {epoch}; }
  double fleet_time(WallTime wall) const { return (wall - epoch) * scale; }
  WallTime wall_time(double fleet) const { return epoch + fleet / scale; }

  bool operator==(const FleetClock&) const = default;
};

}  // namespace coppice
