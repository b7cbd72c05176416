// The strip along the way of a reservation, as the sentinel knows it (docs/safety.md, L14).
//
// Metres in the map frame; seconds of true time.
#pragma once

#include <cstdint>

#include "messages/messages.h"
#include "motion/trajectory/polyline.h"
#include "simulation/committed_line.h"

namespace coppice {

struct ReservedStrip {
  std::uint32_t number = 0;  ///< of the reservation
  Polyline way;
  double stray = 0;           ///< the robot may be so far beside the way
  double relied_until = 0;    ///< somebody counts on the robot to stay in the strip until then
  double replaced_at = 0;     ///< by the next reservation; infinity: it is the newest
  std::uint64_t checked = 0;  ///< the number of the robot's line that was last compared with the strip
  bool holds = true;          ///< that line

  explicit ReservedStrip(const ReservationMessage& reservation);
};

/// Whether a body on its line stays in the strip from `from` on.
bool stays_in(const ReservedStrip& strip, const CommittedLine& line, double from);

}  // namespace coppice
