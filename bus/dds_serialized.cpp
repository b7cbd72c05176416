#include "bus/dds_serialized.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <variant>

#include <fastdds/rtps/common/SerializedPayload.h>

#include "bus/dds_checked_type.h"
#include "bus/dds_conversion.h"
#include "bus/validation.h"

namespace coppice {

namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;

template <class M>
std::optional<Message> read(SerializedPayload_t& payload) {
  CheckedType<typename DdsType<M>::Support> support;
  typename DdsType<M>::Type sample;
  if (!support.deserialize(&payload, &sample)) return std::nullopt;
  return from_dds(sample);
}

template <std::size_t... I>
std::optional<Message> read(std::size_t kind, SerializedPayload_t& payload, std::index_sequence<I...>) {
  constexpr std::array readers{&read<std::variant_alternative_t<I, Message>>...};
  return kind < readers.size() ? readers[kind](payload) : std::nullopt;
}

}  // namespace

std::vector<std::uint8_t> serialized(const Message& message) {
  return std::visit(
      [&]<class M>(const M& m) {
        auto sample = to_dds(m);
        typename DdsType<M>::Support support;
        SerializedPayload_t payload(support.getSerializedSizeProvider(&sample)());
        support.serialize(&sample, &payload);
        std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(message.index())};
        bytes.insert(bytes.end(), payload.data, payload.data + payload.length);
        return bytes;
      },
      message);
}

std::optional<Message> deserialized(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return std::nullopt;
  SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size() - 1));
  std::ranges::copy(bytes.subspan(1), payload.data);
  payload.length = payload.max_size;
  auto message = read(bytes[0], payload, std::make_index_sequence<std::variant_size_v<Message>>());
  if (message && problem_with(*message)) return std::nullopt;
  return message;
}

}  // namespace coppice
