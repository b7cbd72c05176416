// The messages of the bus as a recording keeps them: the Protobuf messages of idl/recording.proto, and back.
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

/// Names a topic of the bus: which alternative of Message its messages are.
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

/// Longest message of a topic, bytes: a map of the largest size, or else a tree, a plan or a batch with room
/// to spare. A list of empty things takes forty times as much memory as it has bytes.
constexpr std::size_t largest_recorded(TopicNumber topic) {
  return std::size_t{topic == topic_number<MapMessage>() ? 40u : 8u} << 20;
}

/// Of the channel that a recording has for a topic.
std::string channel_name(TopicNumber topic);
/// Full name of the topic's Protobuf message.
std::string schema_name(TopicNumber topic);
/// What describes it, as a serialized FileDescriptorSet with all that it depends on.
std::string schema_of(TopicNumber topic);

/// Times in a recording: nanoseconds since 1970. What lies before that becomes that.
std::uint64_t nanoseconds(WallTime at);
WallTime wall_time(std::uint64_t nanoseconds);

/// The same message in the same process gives the same bytes. A map's cells must be as many as its size says,
/// each 0 or 1.
std::string recorded(const Message& message);
/// Nothing if the bytes are no such message, or too many. What it says is not checked beyond that
/// (messages/validation.h).
std::optional<Message> message_in(TopicNumber topic, std::string_view bytes);

}  // namespace coppice
