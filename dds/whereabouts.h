// Where participants are whose hosts have got other addresses.
//
// A participant announces the addresses of its host as they were when it began, and Fast DDS 2.9 sends there
// for ever. When the host has lost or changed its address, nothing arrives there any more. But what the
// participant says goes on to come, and its source tells where the participant is now. Messages to it are
// sent there, too.
//
// The source proves nothing: it is a further destination, and takes the place of no announced one, unless it
// is this host.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>

#include "dds/address_hash.h"
#include "dds/own_networks.h"

namespace coppice {

/// Several threads may use it at a time.
class Whereabouts {
 public:
  using Address = eprosima::fastrtps::rtps::Locator_t;
  using Participant = eprosima::fastrtps::rtps::GuidPrefix_t;

  /// `is_secure`: another process on this host may be hostile, so announced addresses stay.
  Whereabouts(OwnNetworks& own, bool is_secure) : own_(own), is_secure_(is_secure) {}

  /// Another participant has appeared, has changed or has gone.
  void discover(const eprosima::fastrtps::rtps::ParticipantDiscoveryInfo& info);
  /// A message of the participant came from there.
  void hear(const Participant& participant, const Address& source);
  /// Where the participants with these addresses are now, beside the addresses themselves. Removes addresses
  /// at which nobody is any more.
  std::vector<Address> present_of(eprosima::fastdds::rtps::LocatorList& addresses) const;

 private:
  struct Known {
    std::vector<Address> announced{};
    std::optional<Address> source{};  ///< of its last message
    bool moved = false;               ///< its source is none of the announced addresses
  };
  /// Where participants with one announced address are now.
  struct Ways {
    std::vector<Address> present{};
    bool announced_is_void = false;
  };
  bool is_elsewhere(const Known& known);
  void look_anew();
  void change();

  OwnNetworks& own_;
  bool is_secure_;
  mutable std::mutex mutex_;
  std::map<Participant, Known> known_;
  std::uint64_t as_of_ = 0;  ///< of the changes of this host's networks
  std::unordered_map<Address, Ways, AddressHash> ways_;
  std::atomic<bool> some_moved_ = false;
};

}  // namespace coppice
