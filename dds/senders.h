// Which robot's agent each process is, by what its participant announces: so that nobody speaks for another;
// and which ones replay a recording.
//
// A participant is known before anything of it is heard, whichever way processes find each other: its own
// announcement tells how to reach it. What its user data says is as true as the network is closed; where it
// is open, DDS-Security must vouch for participants.
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
  /// Another process is there, has changed or is gone. What it sent before it went is still to be taken.
  void discover(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);
  /// Whose agent it is; empty: nobody's; none: it was never heard of, or has been gone for long.
  std::optional<RobotName> robot_of(const eprosima::fastrtps::rtps::GuidPrefix_t& participant) const;
  /// Whether it says what was recorded of others.
  bool replays(const eprosima::fastrtps::rtps::GuidPrefix_t& participant) const;
  /// Whether anybody who is there does.
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
