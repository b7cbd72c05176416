// Which endpoints a process of a fleet may have, as the table of topics says: for Fast DDS's static
// discovery, in which processes tell each other only which of these they do have.
//
// Where all find each other's endpoints by themselves, each tells each of all of them: with a hundred
// processes that takes far longer than to find the processes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

#include "messages/bus.h"
#include "messages/messages.h"

namespace coppice {

/// What every participant of the fleet is called: the key under which the endpoints are looked up.
inline constexpr const char* static_participant = "coppice";

/// Of the topic of message type M, above 0 and unique in a process.
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

/// The document that Fast DDS takes as the static configuration: of what others may have, that which concerns
/// a process of this role. The rest it then does not keep of hundreds of others.
std::string static_endpoints(Role role);

}  // namespace coppice
