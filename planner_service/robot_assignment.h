// Tells agents that come without a name which robot they are: the first of the scenario that nobody is.
//
// A robot is somebody's for as long as anything is heard of it, and for claim_lease longer: an agent that was
// given it and says so, one that was started with its name, or one from before this service began. Agents
// know that lease too, and count it from when they last spoke, which is earlier. So no two are the same
// robot, and none is two. While the service sleeps, its robots are held for as long. What the desk cannot see
// is an agent that lives where nothing of it is heard for the whole lease: docs/deploy.md.
//
// A state machine, beside the planner service: messages and the time go in, messages come out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "messages/bus.h"
#include "messages/messages.h"

namespace coppice {

class RobotAssignment {
 public:
  /// `robots`: in the order in which they are given away; each once.
  RobotAssignment(const std::vector<RobotName>& robots, WallTime now);

  /// What a service before this one kept: whoever spoke as a robot then may still do so.
  void recall(std::span<const Message> kept, WallTime now);
  void on(const Arrival& arrival);
  /// At least once a second.
  std::vector<Message> step(WallTime now);
  WallTime next_wake() const { return next_wake_; }

 private:
  struct Lease {
    RobotName robot;
    std::uint64_t claimant = 0;  ///< to whom it was given last; 0: to nobody
    std::uint32_t number = 0;    ///< of that one's last claim
    bool taken_up = false;       ///< that one has said so
    bool spoken_for = false;     ///< somebody speaks as this robot, since it was given
    bool answer_due = false;
    WallTime heard = 0;  ///< of it, or of that one
  };
  struct Waiting {
    std::uint64_t claimant = 0;
    std::uint32_t number = 0;
    WallTime heard = 0;
  };

  void receive(const Claim& claim, WallTime now);
  void receive(const AgentStatus& status, WallTime now);
  void follow_clock(WallTime now);
  void take_up(const Claim& claim, WallTime now);
  void wait(const Claim& claim, WallTime now);
  Lease* lease_given_to(std::uint64_t claimant);
  Lease* free_lease(WallTime now);

  std::vector<Lease> leases_;
  std::map<RobotName, std::size_t> lease_of_;
  std::vector<Waiting> waiting_;  ///< in the order in which they came
  WallTime last_step_;
  WallTime next_wake_;
};

}  // namespace coppice
