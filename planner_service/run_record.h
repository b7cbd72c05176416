// What of a run the service keeps, so that another one can go on with it: the missions that it handed out,
// and what the agents said that the report is made of.
#pragma once

#include <cstddef>
#include <map>
#include <span>

#include "messages/keep.h"
#include "messages/messages.h"

namespace coppice {

class RunRecord {
 public:
  /// Goes on after what was kept before.
  void recall(std::span<const Message> kept);
  Keep heard(const Message& message);
  Keep said(const Message& message);

 private:
  struct KnownTrack {
    std::size_t points = 0;
    double begins = 0;  ///< fleet time
  };

  Keep choose(const TrackMessage& track);
  Keep choose(const AgentStatus& status);

  WallTime run_ = 0;  ///< the one that its missions are of; 0: none yet
  std::map<RobotName, AgentStatus> statuses_;
  std::map<RobotName, KnownTrack> tracks_;
};

}  // namespace coppice
