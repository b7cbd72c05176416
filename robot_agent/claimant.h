// Finds out from the service which robot this agent is, where nobody has told it
// (planner_service/robot_assignment.h).
//
// It asks until it is given a robot that nobody speaks as. What it has been given is its own as long as it
// does not fall silent for claim_lease, and nobody else is given it. It counts the lease itself, from when it
// sent the claim that was answered, so that an answer that took long, or a process that was stopped for a
// while, does no harm. Whoever was silent for longer does not ask whether the robot is still its own: it is
// lost, and a new claimant begins where its journal ends. A machine's clock that is set forward by as much
// ends it, too. A state machine.
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
  /// This, or `claim`, at least every two seconds, also when it has its robot: whoever does not is silent.
  std::vector<Outgoing> step(WallTime now);
  WallTime next_wake() const { return next_wake_; }

  /// The next claim, which is to be sent unless the robot is lost by now.
  Claim claim(WallTime now);

  /// None: not yet.
  const std::optional<RobotName>& robot() const { return robot_; }
  /// The robot is another's by now, or may be: nothing must be said as that robot any more.
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
  std::deque<Asked> asked_;  ///< those whose answers still count
  std::optional<Assignment> offer_;
  std::map<RobotName, WallTime> spoke_;  ///< when somebody was last heard as this robot
  std::optional<RobotName> robot_;
  std::optional<WallTime> last_sign_;  ///< of life
  bool lost_ = false;
  WallTime next_wake_ = 0;
};

}  // namespace coppice
