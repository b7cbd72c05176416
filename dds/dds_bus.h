// The bus over Fast DDS: one participant per process, and a writer or reader for each topic of the role.
//
// The bus uses UDP throughout, also within one machine. Shared memory gains little for such small samples,
// costs each process 8 MB and a lock that hundreds of processes wait for, and remains behind when a process
// is killed. Processes find each other by multicast without any configuration, or through discovery servers
// (dds/discovery_server.h) on a network without multicast. No work is done in DDS's own threads: `take` polls
// the readers in the caller's loop.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "dds/datagram.h"
#include "dds/discovery.h"
#include "messages/bus.h"
#include "messages/messages.h"

namespace eprosima::fastdds::dds {
class DomainParticipant;
}

namespace coppice {

struct DdsSettings {
  int domain = 0;  ///< 0..232; fleets on different domains do not see each other
  /// For an agent: the only robot for which it may speak. States that are not for this robot are not sent to
  /// it.
  RobotName robot{};
  /// A way of discovery.h, or discovery servers as "HOST:PORT", separated by ";". If empty: the servers of
  /// ROS_DISCOVERY_SERVER; without these, multicast, or static discovery with security, because encrypted
  /// announcements of endpoints take many times as long.
  std::string discovery{};
  /// Bytes, from datagram_for_networks to datagram_for_one_host.
  int largest_datagram = datagram_for_networks;
  /// Folder with credentials (dds/security.h); empty: no encryption, no authentication.
  std::string security{};
};

/// The version of Fast DDS, as "2.9.1".
std::string dds_version();

/// Examines discovery servers, written as in DdsSettings; looks up the names of hosts. Processes continue
/// without the servers that have no address, as long as another one has.
ServerExamination examine_servers(const std::string& servers);

class DdsBus {
 public:
  /// `sender`: the participant's name, for tools. Throws std::runtime_error if DDS refuses, or if the
  /// discovery servers are not valid addresses.
  DdsBus(const DdsSettings& settings, Role role, const std::string& sender);
  /// Waits until readers have acknowledged the last messages, for 0.5 s at most.
  ~DdsBus();
  DdsBus(const DdsBus&) = delete;
  DdsBus& operator=(const DdsBus&) = delete;

  /// Writes to the message's topic, which the role must write. Waits at most 100 ms for a reliable reader
  /// whose history is full; then the sample is lost and counted.
  void publish(const Outgoing& outgoing);

  /// Returns all messages that arrived since the last call and passed validation.
  std::vector<Arrival> take();

  /// Waits until something arrives or `seconds` are over; true if something arrived.
  bool wait(double seconds);

  /// For endpoints beside the table of topics (ros2/dds_ros.h). The bus must outlive them.
  eprosima::fastdds::dds::DomainParticipant& participant();

  BusCounts counts() const;
  /// Samples that were dropped because they failed validation, or did not come from the robot that they name.
  std::size_t rejected() const;
  /// Whether another process replays a recording.
  bool hears_replay() const;
  /// Samples that could not be written.
  std::size_t lost() const;
  /// Readers, of other processes and of its own, that are matched with this bus's writer of message type M.
  template <class M>
  std::size_t matched_readers() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace coppice
