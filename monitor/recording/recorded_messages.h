// The messages of the bus in a recording: conversion to Protobuf messages and back, field by field. Their
// schema is made from the list of fields (messages/fields.h), and each recording holds it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "messages/messages.h"
#include "messages/topics.h"

namespace coppice {

/// Identifies a topic of the bus: the index of its message type in Message.
using TopicNumber = std::size_t;
inline constexpr std::size_t topic_count = std::variant_size_v<Message>;

/// The table of topics, by number.
inline constexpr std::array<TopicInfo, topic_count> topic_infos = []<class... Ms>(std::variant<Ms...>*) {
  return std::array{Topic<Ms>::info...};
}(static_cast<Message*>(nullptr));

template <class M>
constexpr TopicNumber topic_number() {
  return []<class... Ms>(const std::variant<Ms...>*) {
    TopicNumber number = 0;
    (void)((std::is_same_v<M, Ms> || (++number, false)) || ...);
    return number;
  }(static_cast<const Message*>(nullptr));
}

/// Bytes of a topic's longest message: a map of the largest size, or a tree, a plan or a batch with room to
/// spare. Bounded, because a list of empty elements takes forty times as much memory as bytes.
constexpr std::size_t largest_recorded(TopicNumber topic) {
  return std::size_t{topic == topic_number<MapMessage>() ? 40u : 8u} << 20;
}

/// The name of the channel that a recording has for a topic.
std::string channel_name(TopicNumber topic);
/// Full name of the topic's Protobuf message.
std::string schema_name(TopicNumber topic);
/// The description of the messages of all topics: a serialized FileDescriptorSet.
std::string recorded_schema();

/// Times in a recording are nanoseconds since 1970. Earlier times become 0.
std::uint64_t nanoseconds(WallTime at);
WallTime wall_time(std::uint64_t nanoseconds);

/// The same message in the same process gives the same bytes. A map must have as many cells as its size says,
/// each 0 or 1.
std::string recorded(const Message& message);
/// Returns nothing if the bytes are no message of the topic, or too many. The content is not validated
/// (messages/validation.h).
std::optional<Message> message_in(TopicNumber topic, std::string_view bytes);

}  // namespace coppice
