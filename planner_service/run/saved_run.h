// Which messages of a run the service saves, so that a restarted service can go on with it: the missions that
// it published, with the orders that they serve, and what the agents said that the report is made of.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>

#include "messages/keep.h"
#include "messages/messages.h"
#include "planner_service/run/fleet_memory.h"

namespace coppice {

class RunKeeper {
 public:
  /// The messages that were saved before.
  void recall(std::span<const Message> saved);
  /// What is saved beside the run needs not be saved with it.
  void recall(const FleetMemory& memory);
  Keep heard(const Message& message);
  Keep said(const Message& message);

 private:
  struct KnownTrack {
    std::size_t points = 0;
    double begins = 0;  ///< fleet time
  };

  Keep choose(const TrackMessage& track);
  Keep choose(const AgentStatus& status);
  Keep choose(const OrderStatus& status);

  RunId run_;  ///< the run of the missions; none before the first one
  std::map<RobotName, AgentStatus> statuses_;
  std::map<RobotName, KnownTrack> tracks_;
  std::unordered_map<std::string, std::size_t> orders_;  ///< by id: a hash of the status that is saved
  std::optional<HaltMessage> halts_;
};

}  // namespace coppice
