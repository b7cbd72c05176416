// How long a robot, a broker or the service may be silent until people are told that it is not heard.
#pragma once

#include "messages/run_id.h"

namespace coppice {

/// Seconds. Each of them speaks twice a second at least, so this is no lost message. The page marks what it
/// shows after one second (monitor/web/src/silence.ts).
inline constexpr WallTime lost_after = 3;

inline bool is_lost(WallTime heard, WallTime now) {
  return now - heard > lost_after;
}

}  // namespace coppice
