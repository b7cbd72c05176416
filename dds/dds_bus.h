// The bus over Fast DDS: one participant a process, and a writer or reader for each topic that the role takes
// part in.
//
// UDP throughout, also within one machine: shared memory gains little for samples as small as these, costs
// each process 8 MB and a lock that hundreds wait for, and is left behind by whoever is killed. Processes
// find each other by multicast, with nothing to be configured; or, on a network without multicast, through
// discovery servers (dds_discovery_server.h). Nothing is done in DDS's own threads: `take` polls the readers
// in the caller's loop.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "messages/bus.h"
#include "dds/datagram.h"
#include "dds/discovery.h"
#include "messages/messages.h"

namespace eprosima::fastdds::dds {
class DomainParticipant;
}

namespace coppice {

struct DdsSettings {
  int domain = 0;     ///< 0..232; fleets on different domains do not see each other
  RobotName robot{};  ///< of an agent: it speaks for this one alone, and is not sent what is not for it
  /// A way of discovery.h, or discovery servers as "HOST:PORT", several after each other with ";" between
  /// them. Empty: the servers of ROS_DISCOVERY_SERVER; if that is not set either by multicast, and with
  /// security by static discovery: endpoints that are announced in cipher take many times as long.
  std::string discovery{};
  int largest_datagram = datagram_for_networks;  ///< bytes (datagram.h): the two there and what lies between
  std::string security{};  ///< folder with credentials (dds_security.h); empty: all in clear, with anybody
};

/// Of Fast DDS, as "2.9.1".
std::string dds_version();

/// Of discovery servers as DdsSettings names them; asks the network where hosts are named. Processes go on
/// without those that have no address, where others have one.
ServerExamination examine_servers(const std::string& servers);

class DdsBus {
 public:
  /// `sender` names the participant to tools. Throws std::runtime_error if DDS refuses, or if the discovery
  /// servers are not addresses.
  DdsBus(const DdsSettings& settings, Role role, const std::string& sender);
  /// Waits until what was published last has reached those who listen, half a second at most.
  ~DdsBus();
  DdsBus(const DdsBus&) = delete;
  DdsBus& operator=(const DdsBus&) = delete;

  /// Writes to the message's topic, which the role must be a writer of. Waits at most 100 ms where a reliable
  /// reader lags so far behind that its history is full; then the sample is lost and counted.
  void publish(const Outgoing& outgoing);

  /// Everything that arrived since the last call and passed validation.
  std::vector<Arrival> take();

  /// Until something arrives or `seconds` are over; true if something arrived.
  bool wait(double seconds);

  /// For endpoints beside those of the table (dds_ros.h); the bus outlives them.
  eprosima::fastdds::dds::DomainParticipant& participant();

  BusCounts counts() const;
  /// Samples that were dropped because they failed validation, or came from another than they say.
  std::size_t rejected() const;
  /// Whether another process says again what was recorded.
  bool hears_replay() const;
  /// Samples that could not be written.
  std::size_t lost() const;
  /// Readers of other processes (and its own) that are matched with this bus's writer of message type M.
  template <class M>
  std::size_t matched_readers() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace coppice
