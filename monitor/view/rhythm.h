// Does something at a fixed rate, in a loop that turns more often.
#pragma once

#include "messages/fleet_clock.h"

namespace coppice {

class Rhythm {
 public:
  explicit Rhythm(double period) : period_(period) {}  ///< seconds
  /// Whether the next time has come. If the clock was set back, it continues from the new time.
  bool due(WallTime now) {
    if (now < next_ && next_ <= now + 2 * period_) return false;
    const bool late = now - next_ > period_ || now < next_;
    next_ = (late ? now : next_) + period_;
    return true;
  }

 private:
  double period_;
  WallTime next_ = 0;
};

}  // namespace coppice
