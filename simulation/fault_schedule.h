// The times of the faults of a simulated run: a schedule that follows from the seed.
//
// Seconds of virtual time, which is fleet time.
#pragma once

#include <limits>
#include <vector>

#include "coppice/files/scenario.h"
#include "coppice/simulation/faults.h"

namespace coppice {

/// An agent's clock. It may be wrong, and too fast or too slow.
struct AgentClock {
  double offset = 0;  ///< seconds, of the local time at the true time 0
  double drift = 0;   ///< seconds per second

  double local(double time) const { return time + offset + drift * time; }
  double true_time(double local) const { return (local - offset) / (1 + drift); }
  /// The same clock, if both times are counted from `epoch`.
  AgentClock counted_from(double epoch) const { return {offset + drift * epoch, drift}; }
};

/// The faults of one agent.
struct AgentFaults {
  int side = 0;  ///< side of the partitions
  AgentClock clock{};
  std::vector<double> kills{};  ///< ascending
  double restart_after = std::numeric_limits<double>::infinity();
  std::vector<double> pauses{};  ///< beginnings of the pauses; ascending
  double pause = 0;

  /// The end of the pause that contains `time`, or else `time`.
  double awake_from(double time) const;
  /// The first kill at or after `time`; infinity if there is none.
  double killed_after(double time) const;
};

/// The faults that occurred in a run.
struct SufferedFaults {
  std::size_t lost = 0;  ///< samples that did not arrive, or had to be sent again
  std::size_t kills = 0;
  std::size_t restarts = 0;
  std::size_t pauses = 0;
  std::size_t rejected = 0;  ///< messages that no reader accepts, which is always an error of the sender
};

/// Draws the faults of each robot's agent, from the scenario's seed, for a run of at most `horizon` seconds.
std::vector<AgentFaults> draw_faults(const Faults& faults, const Scenario& scenario, double horizon);

}  // namespace coppice
