// The line on which a body stays if its agent decides nothing more: the present period, one period with the
// chosen velocity, and then braking (docs/safety.md, A1 and L6).
//
// Metres in the map frame; seconds of true time.
#pragma once

#include <optional>

#include "coppice/planning/geometry.h"
#include "motion/body/driver.h"
#include "simulation/fault_schedule.h"

namespace coppice {

struct CommittedLine {
  double begin = 0;   ///< when the body is at the first point
  double period = 1;  ///< between two points; as long as a control period by the agent's clock
  /// Straight from one to the next; the body stands before the first and after the last one. At least one.
  Path points{};

  double end() const { return begin + period * static_cast<double>(points.size() - 1); }
  Point2 at(double time) const;
  /// Metres from `time` on.
  double length_after(double time) const;
  /// Metres per second, at most, from `time` on.
  double fastest_after(double time) const;
  /// When the first point after `time` is reached; infinity: there is none.
  double next_point_after(double time) const;

 private:
  struct Place {
    std::size_t point = 0;  ///< the last one that is reached
    double share = 0;       ///< of the way to the next one
  };
  Place place(double time) const;
};

/// The line of a body, in the memory of `line`. `clock`: counts the times of the body.
void commit(const Driver& body, const AgentClock& clock, CommittedLine& line);

/// When two bodies on their lines come closer than `distance`, at `from` or later; none: they never do.
std::optional<double> first_closer(const CommittedLine& a, const CommittedLine& b, double distance,
                                   double from);

}  // namespace coppice
