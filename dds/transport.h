// UDP for fleets of hundreds of processes. For each datagram it decides which of the destinations need it.
//
// Four cases need this, because neither a participant's settings nor a writer's QoS can express them:
//   - A robot state is for some of the agents only (Outgoing::agents). All agents match with its writer, so
//     that nothing is announced again while robots drive.
//   - Fast DDS answers each discovered participant by announcing itself again to all participants that it
//     knows. So N processes send N^3 announcements. A destination needs an unchanged announcement only now
//     and then.
//   - When Fast DDS repeats a sample about endpoints to one participant, it sends a heartbeat to all, and all
//     answer.
//   - With DDS-Security, Fast DDS sends each step of each pair's authentication to all participants, again
//     N^3.
//
// The transport also opens channels and chooses the addresses of a writer's readers faster than Fast DDS.
// Fast DDS compares each with all others, which takes long where hundreds of processes find each other.
//
// Two parts follow hosts whose networks change: dds/own_networks.h and dds/whereabouts.h.
//
// It also hands on one participant's announcement at a time. Fast DDS 2.9 discovers participants in two
// threads at once, one for multicast and one for unicast, and each overwrites what the other has just read
// (corrected later, in its pull request 4188). One in twenty authentications would never end. Without
// DDS-Security, in every other start one agent of two hundred was never told the states of one other.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <thread>
#include <unordered_map>
#include <vector>

#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/common/LocatorsIterator.hpp>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include "dds/address_hash.h"
#include "dds/own_networks.h"
#include "dds/rtps_message.h"
#include "dds/whereabouts.h"
#include "messages/messages.h"

namespace coppice {

/// The agents that receive this process's next states, and the addresses of all agents.
class Recipients {
 public:
  /// While it exists, messages of this thread go only to these agents, and to all processes that are no
  /// agents.
  class Limit {
   public:
    Limit(Recipients& recipients, std::vector<RobotName> agents);
    ~Limit();
    Limit(const Limit&) = delete;
    Limit& operator=(const Limit&) = delete;

   private:
    Recipients& recipients_;
  };

  /// `is_secure`: a process counts as a robot's agent only after its authentication, and then keeps its
  /// address.
  explicit Recipients(bool is_secure = false) : is_secure_(is_secure) {}

  /// Another process has appeared, has changed or has gone.
  void discover(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);

  /// The process has proved its identity.
  void authenticate(const eprosima::fastrtps::rtps::GUID_t& participant);

  bool is_limited() const { return limited_in_ == std::this_thread::get_id(); }
  /// DDS has chosen the addresses of a writer's readers anew.
  void note_selection() { ++changes_; }
  /// While limited: the addresses of the readers, without those at which all processes are agents other than
  /// the given ones. The range is that of a writer's readers, always of the same writer: it is read only if
  /// anything has changed, because DDS's memory of a hundred readers is slow to go through.
  eprosima::fastdds::rtps::LocatorList among(eprosima::fastrtps::rtps::LocatorsIterator& begin,
                                             const eprosima::fastrtps::rtps::LocatorsIterator& end);

 private:
  using Guid = eprosima::fastrtps::rtps::GUID_t;
  using Address = eprosima::fastrtps::rtps::Locator_t;
  struct Announced {
    RobotName robot;  ///< empty: it is no agent
    std::vector<Address> addresses;
  };
  void place(const Guid& participant, const Announced& announced);
  void sort(eprosima::fastrtps::rtps::LocatorsIterator& begin,
            const eprosima::fastrtps::rtps::LocatorsIterator& end);

  std::atomic<std::thread::id> limited_in_{};  ///< the thread that is limited; none: no limit
  std::vector<RobotName> agents_;
  struct Process {
    Guid participant;
    RobotName robot;  ///< empty: it is no agent
  };
  bool is_secure_;
  mutable std::mutex mutex_;  // DDS discovers in a thread of its own
  /// Several processes share an address after a restart, or where hosts have an address in common, as the
  /// bridge to their containers: Fast DDS takes such an address of another host for the loopback.
  std::unordered_map<Address, std::vector<Process>, AddressHash> at_;
  std::map<Guid, Announced> unproven_;  ///< only if secure, as authenticated_
  std::set<Guid> authenticated_;
  std::atomic<std::uint64_t> changes_ = 1;  ///< of the readers, and of who is where

  /// The addresses of the readers, by who is there. Used by the thread that is limited.
  struct Readers {
    std::uint64_t as_of = 0;  ///< of `changes_`
    std::unordered_map<RobotName, eprosima::fastdds::rtps::LocatorList> agents;
    eprosima::fastdds::rtps::LocatorList others;
  };
  Readers readers_;
};

/// Bytes through this process's sockets.
struct Traffic {
  std::atomic<std::uint64_t> bytes_sent = 0;  ///< payload of all datagrams, without headers
  std::atomic<std::uint64_t> bytes_received = 0;
};

/// A participant's user data, which names the robot whose agent it is; an empty name if it is no agent.
std::vector<std::uint8_t> user_data_of(const RobotName& robot);
RobotName robot_of(std::span<const std::uint8_t> user_data);
/// The user data of a participant that replays a recording.
std::vector<std::uint8_t> user_data_of_replayer();

/// When each destination was last told that this participant is alive, and how many endpoints it has. A
/// multicast group spans several networks (also the loopback), and each has its own sender.
class Announcements {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// Announcements are sent only after this call. Earlier ones, while the participant is set up, would tell
  /// each endpoint to all participants again.
  void begin() { begun_ = true; }
  /// Another participant announces itself. A new participant has been told nothing, even if an earlier one
  /// was told at the same address: after a killed process another one may use its port.
  void hear(std::span<const std::uint8_t> announcement);
  /// The participant has gone. It counts as new if it comes again.
  void forget(const eprosima::fastrtps::rtps::GuidPrefix_t& participant);
  /// Whether the destination must be told now. If so, it counts as told.
  bool is_due(const void* sender, const eprosima::fastrtps::rtps::Locator_t& destination,
              std::uint64_t number, Time now);
  /// The same for a heartbeat about endpoints. The next heartbeat makes up for a dropped one, at the latest
  /// Fast DDS's periodic one.
  bool is_due(const void* sender, const eprosima::fastrtps::rtps::Locator_t& destination,
              const EndpointHeartbeat& news, Time now);
  /// What this sender has told counts as not told: it goes to other networks than before.
  void tell_anew(const void* sender);

 private:
  struct LastHeartbeat {
    EndpointHeartbeat heartbeat;
    Time at{};
  };
  struct Told {
    std::uint64_t number = 0;
    Time at{};
    int repeats = 0;  ///< since the last news
  };
  std::atomic<bool> begun_ = false;
  std::mutex mutex_;
  /// The subject and the destination.
  struct Way {
    const void* sender;  ///< only compared
    eprosima::fastrtps::rtps::Locator_t destination;
    std::uint32_t writer = 0;  ///< of a heartbeat, else 0
    bool operator==(const Way&) const = default;
  };
  struct WayHash {
    std::size_t operator()(const Way& way) const {
      return AddressHash{}(way.destination) ^ std::hash<const void*>{}(way.sender) ^ way.writer;
    }
  };
  std::set<eprosima::fastrtps::rtps::GuidPrefix_t> met_;
  std::unordered_map<Way, Told, WayHash> told_;
  std::unordered_map<Way, LastHeartbeat, WayHash> last_heartbeats_;
};

struct SparingTransportParts {
  Recipients& recipients;
  /// Null if the process announces itself only to discovery servers, which acknowledge.
  Announcements* announcements;
  Traffic& traffic;
  OwnNetworks& networks;
  Whereabouts& whereabouts;
  int largest_datagram;  ///< bytes
  bool is_secure;        ///< with DDS-Security
};

/// A UDPv4 transport with these rules. All parts must outlive the participant.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> sparing_udp_transport(
    const SparingTransportParts& parts);

}  // namespace coppice
