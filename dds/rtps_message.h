// What the RTPS messages of Fast DDS say that the transport treats by themselves (transport.h). The source is
// the DDS-RTPS specification, 2.2.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/Locator.h>

namespace coppice {

/// The number of the announcement, if an RTPS message does nothing but announce its participant.
std::optional<std::uint64_t> announcement_in(std::span<const std::uint8_t> message);

/// The sender of an RTPS message; unknown if the message is none.
eprosima::fastrtps::rtps::GuidPrefix_t sender_of(std::span<const std::uint8_t> message);
/// The addresses at which the announced participant receives announcements of others.
std::vector<eprosima::fastrtps::rtps::Locator_t> addresses_in(std::span<const std::uint8_t> announcement);

/// Content of a heartbeat about a participant's endpoints: the numbers of the first and the last sample.
struct EndpointHeartbeat {
  std::uint32_t writer = 0;  ///< entity id
  std::uint64_t first = 0;   ///< in the octets' order, only to be compared
  std::uint64_t last = 0;
  bool operator==(const EndpointHeartbeat&) const = default;
};
/// The heartbeat, if an RTPS message is nothing else.
std::optional<EndpointHeartbeat> endpoint_heartbeat_in(std::span<const std::uint8_t> message);

/// Whether an RTPS message is a step of an authentication between participants other than its receiver.
bool is_handshake_of_others(std::span<const std::uint8_t> message);

}  // namespace coppice
