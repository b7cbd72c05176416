// UDP for fleets of hundreds of processes: sends only what somebody needs, by deciding for each datagram
// which of its destinations get it.
//
// Four things need that, as neither a participant's settings nor a writer's QoS can say them:
//   - A state is for some of the agents only (Outgoing::agents). All of them match with its writer, so that
//     nothing is announced anew as robots drive.
//   - Fast DDS answers each participant that it discovers by announcing its own to all that it knows already,
//     so that N processes send N^3 announcements. Each destination needs to hear an unchanged one just now
//     and then.
//   - It follows up each sample about endpoints that it repeats to one participant by a heartbeat to
//     all, which all answer.
//   - With DDS-Security, it sends each step of each pair's authentication to all participants, again N^3.
//
// It also opens channels, and chooses the addresses of a writer's readers, in less time than Fast DDS does:
// that goes through all of them for each, which counts where each of hundreds of processes finds all others.
//
// And it hands on one announcement of a participant after the other: Fast DDS 2.9 discovers participants in
// two threads at once, those of multicast and of unicast, and each spoils what the other has just read
// (corrected later, in its pull request 4188). One in twenty authentications would never end. Without
// DDS-Security one agent of two hundred was never told the states of one other, in every other start.
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
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include "messages/messages.h"

namespace coppice {

/// Of the octets in which IPv4 addresses of one fleet differ, and the port.
struct AddressHash {
  std::size_t operator()(const eprosima::fastrtps::rtps::Locator_t& address) const {
    std::uint64_t host = 0;
    std::memcpy(&host, address.address + sizeof(address.address) - sizeof(host), sizeof(host));
    return static_cast<std::size_t>((host ^ address.port * 0x9e3779b97f4a7c15U) * 0xff51afd7ed558ccdU >> 32);
  }
};

/// The agents to which this process's next states are sent, and at which addresses agents are.
class Recipients {
 public:
  /// While it exists, what this thread writes goes to those agents only, and to all who are no agents.
  class Limit {
   public:
    Limit(Recipients& recipients, std::vector<RobotName> agents);
    ~Limit();
    Limit(const Limit&) = delete;
    Limit& operator=(const Limit&) = delete;

   private:
    Recipients& recipients_;
  };

  /// `is_secure`: who says that it is a robot's agent must have been authenticated, and keeps its address.
  explicit Recipients(bool is_secure = false) : is_secure_(is_secure) {}

  /// Another process is there, has changed or is gone.
  void discover(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);

  /// That process is the one that its credentials name.
  void authenticate(const eprosima::fastrtps::rtps::GUID_t& participant);

  bool is_limited() const { return limited_in_ == std::this_thread::get_id(); }
  /// While it is limited: whether this is not an address of agents outside alone.
  bool includes(const eprosima::fastrtps::rtps::Locator_t& address) const;

 private:
  using Guid = eprosima::fastrtps::rtps::GUID_t;
  using Address = eprosima::fastrtps::rtps::Locator_t;
  struct Announced {
    RobotName robot;  ///< empty: none
    std::vector<Address> addresses;
  };
  void place(const Guid& participant, const Announced& announced);

  std::atomic<std::thread::id> limited_in_{};  ///< the thread; none: not
  std::vector<RobotName> agents_;              ///< sorted
  struct Process {
    Guid participant;
    RobotName robot;  ///< empty: it is no agent
  };
  bool is_secure_;
  mutable std::mutex mutex_;  // DDS discovers in a thread of its own
  /// Several at one: after a restart, and where hosts have an address in common, as that of a bridge to their
  /// containers: Fast DDS takes that of another host for the loopback.
  std::unordered_map<Address, std::vector<Process>, AddressHash> at_;
  std::map<Guid, Announced> unproven_;  ///< only where it is secure, as the next
  std::set<Guid> authenticated_;
};

/// What this process's sockets carry.
struct Traffic {
  std::atomic<std::uint64_t> bytes_sent = 0;  ///< of all datagrams, without their headers
  std::atomic<std::uint64_t> bytes_received = 0;
};

/// What a participant's user data says of the robot whose agent it is; empty: it is none.
std::vector<std::uint8_t> user_data_of(const RobotName& robot);
RobotName robot_of(std::span<const std::uint8_t> user_data);
/// The user data of one that replays a recording.
std::vector<std::uint8_t> user_data_of_replayer();

/// If an RTPS message only announces that its participant is alive: the number of what it says of itself.
std::optional<std::uint64_t> announcement_in(std::span<const std::uint8_t> message);

/// Whose message it is; unknown if it is none.
eprosima::fastrtps::rtps::GuidPrefix_t sender_of(std::span<const std::uint8_t> message);
/// At which addresses the participant that announces itself wants to hear of others.
std::vector<eprosima::fastrtps::rtps::Locator_t> addresses_in(std::span<const std::uint8_t> announcement);

/// What a heartbeat says of the samples about a participant's endpoints: the numbers of the first and the
/// last.
struct EndpointHeartbeat {
  std::uint32_t writer = 0;  ///< entity id
  std::uint64_t first = 0;   ///< as the octets are; to be compared only
  std::uint64_t last = 0;
  bool operator==(const EndpointHeartbeat&) const = default;
};
/// If an RTPS message is nothing but such a heartbeat, for whoever gets it.
std::optional<EndpointHeartbeat> endpoint_heartbeat_in(std::span<const std::uint8_t> message);

/// When each destination was last told that this participant is alive, and how many endpoints it has. A group
/// lies on several networks (also on the one within the host), each with a sender of its own.
class Announcements {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// From now on: before, while it is set up, each of its endpoints would be told to all anew.
  void begin() { begun_ = true; }
  /// Another participant announces itself. A new one has been told nothing, whoever was told before at its
  /// addresses: one that was killed is followed by another at the same port.
  void hear(std::span<const std::uint8_t> announcement);
  /// It is gone: it is new if it comes again.
  void forget(const eprosima::fastrtps::rtps::GuidPrefix_t& participant);
  /// Whether it must be told now; then it counts as told.
  bool is_due(const eprosima::fastrtps::rtps::SenderResource* sender,
              const eprosima::fastrtps::rtps::Locator_t& destination, std::uint64_t number, Time now);
  /// Likewise of its endpoints. One that is left out is made up for by the next, at the latest by Fast DDS's
  /// periodic one.
  bool is_due(const eprosima::fastrtps::rtps::SenderResource* sender,
              const eprosima::fastrtps::rtps::Locator_t& destination, const EndpointHeartbeat& beat,
              Time now);

 private:
  struct Beaten {
    EndpointHeartbeat heartbeat;
    Time at{};
  };
  struct Told {
    std::uint64_t number = 0;
    Time at{};
    int repeats = 0;  ///< since it was news
  };
  std::atomic<bool> begun_ = false;
  std::mutex mutex_;
  /// What about, and to where.
  struct Way {
    const eprosima::fastrtps::rtps::SenderResource* sender;
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
  std::unordered_map<Way, Beaten, WayHash> beaten_;
};

/// Whether an RTPS message is a step of an authentication between others than the participant that it is
/// sent to.
bool is_handshake_of_others(std::span<const std::uint8_t> message);

struct SparingTransportParts {
  Recipients& recipients;
  Announcements*
      announcements;  ///< null where it announces itself to discovery servers only, which acknowledge
  Traffic& traffic;
  int largest_datagram;  ///< bytes
  bool is_secure;        ///< with DDS-Security
};

/// Of UDPv4 transports that do so. All parts must outlive the participant.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> sparing_udp_transport(
    const SparingTransportParts& parts);

}  // namespace coppice
