// The endpoints that a process of a fleet may have, by the table of topics. With Fast DDS's static discovery,
// processes tell each other only which of these endpoints they have.
//
// With the usual discovery, each process announces each endpoint to every other process. With a hundred
// processes that takes far longer than finding the processes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

#include "messages/bus.h"
#include "messages/messages.h"

namespace coppice {

/// The name of every participant of the fleet, under which Fast DDS looks up the endpoints.
inline constexpr const char* static_participant = "coppice";

/// Ids of the endpoints of message type M: above 0 and unique in a process.
template <class M>
constexpr std::uint16_t writer_id() {
  return []<class... Ms>(const std::variant<Ms...>*) {
    std::uint16_t number = 0;
    (void)((++number, std::is_same_v<M, Ms>) || ...);
    return static_cast<std::uint16_t>(2 * number - 1);
  }(static_cast<const Message*>(nullptr));
}
template <class M>
constexpr std::uint16_t reader_id() {
  return writer_id<M>() + 1;
}

/// The document for Fast DDS's static configuration. It lists only the endpoints of others that match one of
/// this role, so that Fast DDS does not store the rest for hundreds of processes.
std::string static_endpoints(Role role);

}  // namespace coppice
