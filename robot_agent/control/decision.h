// What a robot does next, and why: the outcome of its control step.
//
// Agents decide in three steps. A situation says all that counts (situation.h). decide() maps it to a
// decision, and changes nothing. The run carries the decision out, and tells others of it (control_step.cpp).
// The decision is the only place that knows the cause: status, report, log and page read it there.
//
// Seconds of fleet time; metres per second and radians per second.
#pragma once

#include <cstdint>
#include <variant>

#include "coppice/motion/kinematics.h"
#include "robot_agent/control/situation.h"

namespace coppice {

/// What the robot is about, or what keeps it from coming on.
enum class Cause : std::uint8_t {
  // It is held: its body brakes, and it evades nobody.
  halted,      ///< an operator has told it to stand
  joining,     ///< its process began in mid-run, and does not know where all others are
  odometry,    ///< the robot that follows its body is not where it should be
  listening,   ///< it is cut off, or was, and hears what it missed
  strip,       ///< others may rely on it to stay in the strip of the reservation that it gave up
  plans_anew,  ///< its reservation has become useless
  // It has no way of its own to drive. Without a reservation it moves where others want to pass.
  idle,        ///< it has nothing to do
  planning,    ///< it has no path yet
  joint_plan,  ///< it waits for a joint plan
  startup,     ///< it does not know where all others are
  stranded,    ///< no joint plan brings it to its goal
  // It drives.
  wall,         ///< away from an obstacle that it overlaps
  reservation,  ///< it has a path, and no reservation yet
  gate,         ///< along its reservation, and a robot there goes first
  promise       ///< along its way, as far as the others may not come there
};

/// Whether the robot stands for sure until it is let go, and so may bind itself to stand.
constexpr bool stands_until_let_go(Cause cause) {
  return cause == Cause::halted || cause == Cause::joining || cause == Cause::odometry ||
         cause == Cause::listening;
}
/// Whether the robot has a way to drive, and only others keep it from that: it may stall.
constexpr bool may_stall(Cause cause) {
  return cause == Cause::reservation || cause == Cause::gate || cause == Cause::promise;
}

/// The body brakes on the line of the last decision.
struct Brake {};
/// The body stands, and is bound to stand until a time. It may turn on the spot.
struct StandUntil {
  double until;
  double angular_velocity;
};
/// The body drives along its way, or turns to where it leads.
struct Follow {
  Twist next;
};
/// The body stands, or moves out of the others' way.
struct Evade {
  Twist next;
};

struct Decision {
  std::variant<Brake, StandUntil, Follow, Evade> action = Brake{};
  Cause cause = Cause::idle;
  /// The robot has a reason to stand: this period does not count as one without progress.
  bool pauses_stall_clock = false;
  /// The robot moves along its way, or waits for a robot that does: it is not held up.
  bool comes_on = false;
  /// False: something that stands is between the robot and the point for which it heads.
  bool is_led = true;
};

/// The order of the cases is the order of what counts: holds first.
Decision decide(const Situation& situation);

/// Whether nothing holds the robot, and it has a way to drive along: its reservation, or its path.
bool drives(const Situation& situation);

/// What the body does from the decision time on.
Twist next_twist(const Decision& decision, const Driver& body);

}  // namespace coppice
