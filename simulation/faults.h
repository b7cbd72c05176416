// The faults of a simulated run and their times: a schedule that follows from the seed.
//
// Seconds of virtual time, which is fleet time.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "files/scenario.h"
#include "simulation/simulated_bus.h"

namespace coppice {

struct Faults {
  BusFaults bus;  ///< each agent is on a random side of the partitions; service and broker are on side 0
  double kill_rate = 0;   ///< agents killed per robot and hour
  double pause_rate = 0;  ///< pauses per robot and hour
  double pause = 1;       ///< duration of a pause, seconds
  double clock_skew = 0;  ///< seconds by which an agent's clock may be wrong, in either direction
  struct Kill {
    std::string robot;
    double time = 0;
    bool for_good = false;  ///< the agent is not restarted
  };
  std::vector<Kill> kills{};  ///< in addition to the random ones
  /// Seconds after which the process of a killed agent is restarted; infinity: never.
  double restart_after = std::numeric_limits<double>::infinity();
};

/// The faults of one agent.
struct AgentFaults {
  int side = 0;  ///< side of the partitions
  double clock_offset = 0;
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
