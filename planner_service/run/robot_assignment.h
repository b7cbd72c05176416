// Tells agents that come without a name which robot they are: the first robot of the scenario that is free.
//
// An agent has its robot for as long as anything is heard of that robot, and for `claim_lease` longer. This
// holds for an agent that was assigned the robot and confirmed it, for one that was started with the robot's
// name, and for one from before this service started. Agents know the lease too. They count it from when they
// last spoke, which is earlier than the service heard them. So no two agents are the same robot, and no agent
// is two robots. The leases do not run while the service is paused. The service cannot see an agent that
// lives while nothing of it is heard for the whole lease: docs/deploy.md.
//
// A state machine, beside the planner service: messages and the time go in, messages come out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"

namespace coppice {

class RobotAssignment {
 public:
  /// `robots`: in the order in which they are assigned; each once.
  RobotAssignment(const std::vector<RobotName>& robots, WallTime now);

  /// Restores the messages that a service before this one saved: an agent that it heard may still live.
  void recall(std::span<const Message> saved, WallTime now);
  void on(const Arrival& arrival);
  /// Call it at least once a second.
  std::vector<Message> step(WallTime now);
  WallTime next_wake() const { return next_wake_; }

 private:
  enum class Stage : unsigned char {
    offered,
    contested,  ///< offered; and an agent that may be another one speaks as this robot
    confirmed,  ///< the claimant said that it is this robot
  };
  /// The claimant that the robot was assigned to last.
  struct Holder {
    std::uint64_t claimant = 0;
    std::uint32_t number = 0;  ///< of its last claim
    Stage stage = Stage::offered;
    bool answer_due = false;  ///< the next step says who holds the robot
  };
  struct Lease {
    RobotName robot;
    std::optional<Holder> holder{};  ///< none: the robot is free, or its agent was started with its name
    WallTime heard_at = 0;           ///< when the robot, or its holder, was last heard
  };
  struct Waiting {
    std::uint64_t claimant = 0;
    std::uint32_t number = 0;
    WallTime heard_at = 0;
  };

  void receive(const Claim& claim, WallTime now);
  void receive(const AgentStatus& status, WallTime now);
  void follow_clock(WallTime now);
  void confirm(const Claim& claim, WallTime now);
  void wait(const Claim& claim, WallTime now);
  Lease* lease_of(std::uint64_t claimant);
  Lease* free_lease(WallTime now);

  std::vector<Lease> leases_;
  std::map<RobotName, std::size_t> index_;
  std::vector<Waiting> waiting_;  ///< in the order in which they came
  WallTime last_step_;
  WallTime next_wake_;
};

}  // namespace coppice
