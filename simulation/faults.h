// What goes wrong in a simulated run, and when: a schedule that follows from the seed.
//
// Seconds of virtual time, which is fleet time.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "planning/random.h"
#include "simulation/simulated_bus.h"

namespace coppice {

struct Faults {
  BusFaults bus;  ///< its partitions put each agent on a side of its own draw; service and broker are on one
  double kill_rate = 0;   ///< agents killed, for each robot and hour
  double pause_rate = 0;  ///< agents that stop and go on later, for each robot and hour
  double pause = 1;       ///< seconds
  double clock_skew = 0;  ///< seconds by which an agent's clock may be wrong, either way
  struct Kill {
    std::string robot;
    double time = 0;
    bool for_good = false;  ///< it is not started anew
  };
  std::vector<Kill> kills{};  ///< beyond those that are drawn
  /// Seconds after which the process of a killed agent is started anew; infinity: never.
  double restart_after = std::numeric_limits<double>::infinity();
};

/// What happens to one agent.
struct AgentFaults {
  int side = 0;  ///< of partitions
  double clock_offset = 0;
  std::vector<double> kills{};  ///< in order
  double restart_after = std::numeric_limits<double>::infinity();
  std::vector<double> pauses{};  ///< when they begin; in order
  double pause = 0;

  /// The end of the pause that holds `time`, or `time`.
  double awake_from(double time) const;
  /// The first kill from `time` on; infinity if none.
  double killed_after(double time) const;
};

/// What came of it in a run.
struct SufferedFaults {
  std::size_t lost = 0;  ///< samples that did not arrive, or had to be sent again
  std::size_t kills = 0;
  std::size_t restarts = 0;
  std::size_t pauses = 0;
  std::size_t rejected = 0;  ///< messages that no reader takes: always a mistake of the sender
};

/// For a run of at most `horizon` seconds.
AgentFaults draw_faults(const Faults& faults, const std::string& robot, double horizon, Random& random);

}  // namespace coppice
