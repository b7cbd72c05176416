// The faults that a simulated run is to suffer.
//
// Seconds of virtual time, which is fleet time.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace coppice {

/// An interval in which the participants of two sides do not reach each other, seconds.
struct Partition {
  double from = 0;
  double until = 0;
};

/// An interval in which two agents do not reach each other, although all others reach both, seconds.
struct CutLink {
  std::string a;  ///< name of a robot
  std::string b;
  double from = 0;
  double until = 0;
};

struct BusFaults {
  double loss = 0;    ///< share of the samples that are lost, below 1; reliable ones are sent again
  double delay = 0;   ///< seconds that each sample takes in addition; not for samples kept for late joiners
  double jitter = 0;  ///< seconds by which the additional delay may be longer or shorter
  double duplicate = 0;  ///< share of the best-effort samples that arrive twice
  bool reorder = false;  ///< best-effort samples of one sender may overtake each other
  std::vector<Partition> partitions{};
  std::vector<CutLink> cut_links{};
};

/// The robots follow their agents, as real ones do, and not exactly. Their tasks need tracking
/// tolerances for that.
struct DriveFaults {
  double odometry_noise = 0;  ///< metres; standard deviation. The yaw has as many radians
  double lag = 0;             ///< seconds; time constant of the drive
  double slip = 0;            ///< largest share of a wheel's speed that is lost; drawn for each wheel
};
inline bool is_any(const DriveFaults& faults) {
  return faults.odometry_noise > 0 || faults.lag > 0 || faults.slip > 0;
}

struct Faults {
  BusFaults bus{};  ///< each agent is on a random side of the partitions; service and broker are on side 0
  double kill_rate = 0;    ///< agents killed per robot and hour
  double pause_rate = 0;   ///< pauses per robot and hour
  double pause = 1;        ///< duration of a pause, seconds
  double clock_skew = 0;   ///< seconds by which an agent's clock may be wrong, in either direction
  double clock_drift = 0;  ///< seconds per second by which the rates of two agents' clocks differ at most
  struct Kill {
    std::string robot;
    double time = 0;
    bool for_good = false;  ///< the agent is not restarted
  };
  std::vector<Kill> kills{};  ///< in addition to the random ones
  /// Seconds after which the process of a killed agent is restarted; infinity: never.
  double restart_after = std::numeric_limits<double>::infinity();
  DriveFaults drive{};
};

}  // namespace coppice
