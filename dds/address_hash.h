// A hash of the addresses of a fleet, for tables by address.
#pragma once

#include <cstdint>
#include <cstring>

#include <fastdds/rtps/common/Locator.h>

namespace coppice {

/// Hashes the octets in which the IPv4 addresses of a fleet differ, and the port.
struct AddressHash {
  std::size_t operator()(const eprosima::fastrtps::rtps::Locator_t& address) const {
    std::uint64_t host = 0;
    std::memcpy(&host, address.address + sizeof(address.address) - sizeof(host), sizeof(host));
    return static_cast<std::size_t>((host ^ address.port * 0x9e3779b97f4a7c15U) * 0xff51afd7ed558ccdU >> 32);
  }
};

}  // namespace coppice
