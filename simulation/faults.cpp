#include "simulation/faults.h"

#include <algorithm>
#include <cmath>

namespace coppice {

namespace {

constexpr double hour = 3600;

/// Until the next of events that happen `rate` times an hour; infinity for none.
double gap(double rate, Random& random) {
  return rate > 0 ? -std::log(1 - random.uniform()) * hour / rate : std::numeric_limits<double>::infinity();
}

}  // namespace

double AgentFaults::awake_from(double time) const {
  const auto next = std::ranges::upper_bound(pauses, time);
  return next == pauses.begin() ? time : std::max(time, *(next - 1) + pause);
}

AgentFaults draw_faults(const Faults& faults, const std::string& robot, double horizon, Random& random) {
  AgentFaults drawn{.side = static_cast<int>(random.index(2)),
                    .clock_offset = random.uniform(-faults.clock_skew, faults.clock_skew),
                    .killed_at = gap(faults.kill_rate, random),
                    .pause = faults.pause};
  for (double t = gap(faults.pause_rate, random); t < horizon;
       t += faults.pause + gap(faults.pause_rate, random))
    drawn.pauses.push_back(t);
  for (const Faults::Kill& kill : faults.kills) {
    if (kill.robot == robot) drawn.killed_at = std::min(drawn.killed_at, kill.time);
  }
  return drawn;
}

}  // namespace coppice
