// Which robot's agent each process is, and which processes replay a recording, as their participants announce
// it. So no process can speak for another robot.
//
// A participant is known before any of its samples arrives, with each way of discovery, because its
// announcement says how to reach it. Its user data can be trusted only in a closed network; in an open one,
// DDS-Security must authenticate the participants.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <optional>

#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>

#include "messages/messages.h"

namespace coppice {

class Senders {
 public:
  void note_own(const eprosima::fastrtps::rtps::GuidPrefix_t& participant, const RobotName& robot,
                bool replays);
  /// Another process has appeared, has changed or has gone. Its last samples may still be taken after it has
  /// gone.
  void discover(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);
  /// The robot whose agent the participant is; empty: it is no agent; nullopt: never discovered, or gone for
  /// long.
  std::optional<RobotName> robot_of(const eprosima::fastrtps::rtps::GuidPrefix_t& participant) const;
  /// Whether the participant replays a recording.
  bool replays(const eprosima::fastrtps::rtps::GuidPrefix_t& participant) const;
  /// Whether any participant that is still there replays a recording.
  bool somebody_replays() const;

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Sender {
    RobotName robot{};
    bool replays = false;
    std::optional<Time> gone_at{};
  };
  mutable std::mutex mutex_;  // DDS discovers in a thread of its own
  std::map<eprosima::fastrtps::rtps::GuidPrefix_t, Sender> senders_;
};

}  // namespace coppice
