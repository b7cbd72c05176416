#include "dds/rtps_message.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace coppice {

namespace rtps = eprosima::fastrtps::rtps;

using Bytes = std::span<const std::uint8_t>;

namespace {

// DDS-RTPS 2.2, 8.3.3 (messages) and 9.4.5 (submessages).
constexpr std::uint8_t heartbeat = 0x07;
constexpr std::uint8_t info_timestamp = 0x09;
constexpr std::uint8_t info_destination = 0x0e;
constexpr std::uint8_t data = 0x15;
constexpr std::uint8_t first_of_vendors = 0x80;
constexpr std::uint8_t is_little_endian = 0x01;
constexpr std::uint8_t holds_data = 0x04;
constexpr std::size_t submessage_header = 4;
constexpr std::size_t prefix_length = 12;  // of a participant's GUID
constexpr std::size_t writer_at = 12;      // of a data submessage; its sequence number follows

using EntityId = std::array<std::uint8_t, 4>;

/// Calls `wants_more` with each submessage, from its header to the end of the message, until it returns
/// false.
template <class WantsMore>
void for_each_submessage(Bytes message, WantsMore&& wants_more) {
  constexpr std::size_t header = 20;
  for (std::size_t at = header; at + submessage_header <= message.size();) {
    const Bytes rest = message.subspan(at);
    if (!wants_more(rest)) return;
    const bool little = (rest[1] & is_little_endian) != 0;
    const std::size_t length = little ? rest[2] | rest[3] << 8 : rest[2] << 8 | rest[3];
    if (length == 0) return;  // it extends to the end of the message
    at += submessage_header + length;
  }
}

/// Reads the octets as one big-endian number.
std::uint64_t number_of(Bytes octets) {
  std::uint64_t number = 0;
  for (const std::uint8_t octet : octets) number = number << 8 | octet;
  return number;
}

bool holds_data_of(const EntityId& writer, Bytes submessage) {
  return submessage.size() >= writer_at + 12 && (submessage[1] & holds_data) != 0 &&
         std::ranges::equal(submessage.subspan(writer_at, 4), writer);
}

}  // namespace

/// DDS-RTPS 2.2, 8.5.3 (participant discovery).
std::optional<std::uint64_t> announcement_in(Bytes message) {
  constexpr EntityId participant_writer{0x00, 0x01, 0x00, 0xc2};
  std::optional<std::uint64_t> number;
  bool says_more = false;
  for_each_submessage(message, [&](Bytes submessage) {
    const std::uint8_t kind = submessage[0];
    if (kind == data && !number && holds_data_of(participant_writer, submessage)) {
      number = number_of(submessage.subspan(writer_at + 4, 8));
    } else {
      says_more = kind != info_timestamp && kind < first_of_vendors;
    }
    return !says_more;
  });
  return says_more ? std::nullopt : number;
}

/// DDS-RTPS 2.2, 9.4.4 (header).
rtps::GuidPrefix_t sender_of(Bytes message) {
  constexpr std::size_t prefix_at = 8;
  rtps::GuidPrefix_t sender;
  if (message.size() >= prefix_at + prefix_length)
    std::ranges::copy(message.subspan(prefix_at, prefix_length), sender.value);
  return sender;
}

/// DDS-RTPS 2.2, 9.4.5.3 (data), 9.4.2.11 (lists of parameters) and 9.6.2.2.2 (what they say).
std::vector<rtps::Locator_t> addresses_in(Bytes announcement) {
  constexpr std::uint16_t locators_of_discovery = 0x0032;
  constexpr std::uint16_t sentinel = 0x0001;
  constexpr std::size_t locator_length = 24;
  constexpr std::size_t payload_at = 24;
  constexpr std::size_t encapsulation = 4;
  constexpr std::uint8_t has_inline_qos = 0x02;
  std::vector<rtps::Locator_t> addresses;
  for_each_submessage(announcement, [&](Bytes submessage) {
    if (submessage[0] != data || (submessage[1] & has_inline_qos) != 0 ||
        submessage.size() < payload_at + encapsulation)
      return true;
    const bool little = (submessage[payload_at + 1] & is_little_endian) != 0;
    Bytes rest = submessage.subspan(payload_at + encapsulation);
    while (rest.size() >= 4) {
      const auto id = static_cast<std::uint16_t>(little ? rest[0] | rest[1] << 8 : rest[0] << 8 | rest[1]);
      const std::size_t length = little ? rest[2] | rest[3] << 8 : rest[2] << 8 | rest[3];
      rest = rest.subspan(4);
      if (id == sentinel || length > rest.size()) break;
      if (id == locators_of_discovery && length == locator_length) {
        const auto number = [&](std::size_t at) {
          std::array<std::uint8_t, 4> octets{};
          std::ranges::copy(rest.subspan(at, 4), octets.begin());
          if (little) std::ranges::reverse(octets);
          return static_cast<std::uint32_t>(number_of(octets));
        };
        rtps::Locator_t locator(static_cast<std::int32_t>(number(0)), number(4));
        std::ranges::copy(rest.subspan(8, 16), locator.address);
        addresses.push_back(locator);
      }
      rest = rest.subspan(length);
    }
    return false;
  });
  return addresses;
}

/// DDS-RTPS 2.2, 8.3.7.5 (heartbeats) and 8.5.4 (endpoint discovery).
std::optional<EndpointHeartbeat> endpoint_heartbeat_in(Bytes message) {
  constexpr std::uint32_t publications_writer = 0x0003c2;
  constexpr std::uint32_t subscriptions_writer = 0x0004c2;
  constexpr std::size_t numbers_at = 12;  // after the ids of the reader and the writer
  std::optional<EndpointHeartbeat> found;
  bool says_more = false;
  for_each_submessage(message, [&](Bytes submessage) {
    const std::uint8_t kind = submessage[0];
    if (kind == heartbeat && !found && submessage.size() >= numbers_at + 16) {
      found = {.writer = static_cast<std::uint32_t>(number_of(submessage.subspan(numbers_at - 4, 4))),
               .first = number_of(submessage.subspan(numbers_at, 8)),
               .last = number_of(submessage.subspan(numbers_at + 8, 8))};
      says_more = found->writer != publications_writer && found->writer != subscriptions_writer;
    } else {
      says_more = kind != info_timestamp && kind < first_of_vendors;
    }
    return !says_more;
  });
  return says_more ? std::nullopt : found;
}

/// DDS-Security 1.1, 7.4.3 (ParticipantStatelessMessage).
bool is_handshake_of_others(Bytes message) {
  constexpr EntityId handshake_writer{0x00, 0x02, 0x01, 0xc3};
  constexpr std::size_t payload_at = 24;  // of a data submessage without inline QoS
  // After the encapsulation, the message's own identity and the identity of the message that it answers.
  constexpr std::size_t destination_at = payload_at + 4 + 24 + 24;
  Bytes receiver;
  bool of_others = false;
  for_each_submessage(message, [&](Bytes submessage) {
    if (submessage[0] == info_destination && submessage.size() >= submessage_header + prefix_length)
      receiver = submessage.subspan(submessage_header, prefix_length);
    of_others = submessage[0] == data && !receiver.empty() && holds_data_of(handshake_writer, submessage) &&
                submessage.size() >= destination_at + prefix_length &&
                !std::ranges::equal(submessage.subspan(destination_at, prefix_length), receiver);
    return !of_others;
  });
  return of_others;
}

}  // namespace coppice
