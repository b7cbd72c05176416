// Asks the service which robot this agent is, if the agent was not told
// (planner_service/run/robot_assignment.h).
//
// The claimant asks until it is given a robot that no other agent speaks as. The robot stays its own as long
// as it does not fall silent for `claim_lease`; nobody else is given the robot meanwhile. The claimant counts
// the lease itself, from the moment when it sent the claim that was answered. So a late answer, or a process
// that was stopped for a while, does no harm. A claimant that was silent for longer has lost its robot, and
// does not ask whether the robot is still its own. A new claimant begins where its journal ends. A machine's
// clock that is set forward by as much ends the lease, too. A state machine.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"

namespace coppice {

class Claimant {
 public:
  /// `id`: drawn at random, above 0.
  explicit Claimant(std::uint64_t id) : id_(id) {}

  void on(const Arrival& arrival);
  /// Call this, or `claim`, at least every 2 s, also when the claimant has its robot. Otherwise it is silent.
  std::vector<Outgoing> step(WallTime now);
  WallTime next_wake() const { return next_wake_; }

  /// The next claim, which is to be sent unless the robot is lost by now.
  Claim claim(WallTime now);

  /// The assigned robot; none: the service has assigned none yet.
  const std::optional<RobotName>& robot() const { return robot_; }
  /// The robot belongs to another agent by now, or may do so: nothing must be said as that robot any more.
  bool lost() const { return lost_; }

 private:
  void receive(const Assignment& assignment, WallTime now);
  void receive(const RobotState& state, WallTime now);
  void count_silence(WallTime now);
  bool may_take(const Assignment& offer, WallTime now) const;

  struct Asked {
    std::uint32_t number = 0;
    WallTime at = 0;
  };

  std::uint64_t id_;
  std::uint32_t number_ = 0;
  std::deque<Asked> asked_;  ///< claims whose answers still count
  std::optional<Assignment> offer_;
  std::map<RobotName, WallTime> spoke_;  ///< when an agent was last heard as this robot
  std::optional<RobotName> robot_;
  std::optional<WallTime> last_sign_;  ///< when the claimant was last not silent
  bool lost_ = false;
  WallTime next_wake_ = 0;
};

}  // namespace coppice
