#include "dds/serialized.h"

#include <array>
#include <cstddef>
#include <utility>
#include <variant>

#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/Exception.h>

#include "dds/conversion.h"
#include "messages/validation.h"

namespace coppice {

namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

constexpr std::size_t encapsulation = 4;  // bytes: the byte order

// Does not use a topic's generated support: its constructor counts the bytes of the largest sample one by
// one.
template <class M>
std::optional<Message> read(std::span<char> bytes) {
  typename DdsType<M>::Type sample;
  try {
    FastBuffer buffer(bytes.data(), bytes.size());
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    sample.deserialize(cdr);
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return std::nullopt;
  }
  return from_dds(sample);
}

template <std::size_t... I>
std::optional<Message> read(std::size_t kind, std::span<char> bytes, std::index_sequence<I...>) {
  constexpr std::array readers{&read<std::variant_alternative_t<I, Message>>...};
  return kind < readers.size() ? readers[kind](bytes) : std::nullopt;
}

}  // namespace

std::vector<std::uint8_t> serialized(const Message& message) {
  return std::visit(
      [&]<class M>(const M& m) {
        const auto sample = to_dds(m);
        std::vector<std::uint8_t> bytes(1 + encapsulation + sample.getCdrSerializedSize(sample));
        bytes[0] = static_cast<std::uint8_t>(message.index());
        FastBuffer buffer(reinterpret_cast<char*>(bytes.data()) + 1, bytes.size() - 1);
        Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
        cdr.serialize_encapsulation();
        sample.serialize(cdr);
        bytes.resize(1 + cdr.getSerializedDataLength());
        return bytes;
      },
      message);
}

std::optional<Message> deserialized(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return std::nullopt;
  std::vector<char> sample(bytes.begin() + 1, bytes.end());
  auto message = read(bytes[0], sample, std::make_index_sequence<std::variant_size_v<Message>>());
  if (message && problem_with(*message)) return std::nullopt;
  return message;
}

}  // namespace coppice
