// What a robot does at a moment, or why it stands: a value, as the agent's own cause
// (robot_agent/control/decision.h), read from what the agent said.
//
// States tell at once for whom a robot waits. Statuses tell twice a second for how long it waited, and by
// what. So where states do not tell the cause, the wait that grew between two statuses does.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "monitor/recording/fleet_moment.h"

namespace coppice {

enum class Act : std::uint8_t {
  // It is under way.
  drives,
  turns,        ///< on the spot
  leaves_wall,  ///< it drives away from an obstacle that it overlaps
  // It is under way, and hardly moves.
  gate,         ///< another robot goes first
  blocked,      ///< another robot may come where it wants to go
  reservation,  ///< it has no reservation, or one that has become useless
  joint_plan,   ///< it stands until there is one
  stranded,     ///< no joint plan brings it to its goal
  startup,      ///< it does not know where all others are
  joining,      ///< its agent began in mid-run
  contact,      ///< it is cut off, or was
  odometry,     ///< the robot that follows its body is not where it should be
  // It has nothing to drive.
  aside,  ///< without a way of its own it moves where others do not want to pass
  waits,  ///< for a map or a mission
  plans,  ///< it looks for a path
  halted,
  gave_up,
  no_path,
  arrived,
  ended,  ///< its run is over
  silent  ///< it is not heard
};

struct Doing {
  Act act = Act::waits;
  RobotName
      other{};  ///< gate: goes first; blocked: is in the way; joint_plan, stranded: makes it; empty: nobody
  std::string words{};  ///< of the agent itself, or a reason; empty: none
};

/// How long a robot waited between the two statuses around a moment, and its own words for that.
struct Waited {
  WaitTimes grown{};
  std::string words{};
};

/// All statuses of a recording, by robot.
class WaitLog {
 public:
  /// In the order of time.
  void on(const AgentStatus& status, WallTime at);
  Waited around(const RobotName& robot, WallTime at) const;

 private:
  struct Entry {
    WallTime at;
    std::uint32_t mission;
    RunId run;
    WaitTimes waits;
    std::string words;
  };
  std::map<RobotName, std::vector<Entry>> entries_;
};

/// The robot that is nearest to this one, and so close that it may stop it; null: none.
const SeenRobot* in_the_way(const FleetMoment& moment, const RobotState& robot);

/// What the robot did when it said its last state. It has said one.
Doing doing_of(const FleetMoment& moment, const SeenRobot& robot, const Waited& waited);

}  // namespace coppice
