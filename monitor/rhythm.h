// What is done so many times a second, by a loop that turns more often.
#pragma once

#include "messages/fleet_clock.h"

namespace coppice {

class Rhythm {
 public:
  explicit Rhythm(double period) : period_(period) {}  ///< seconds
  /// Whether it is time again. A clock that was set back is taken as it is.
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
