#include "monitor/recording/recorded_messages.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "messages/fields.h"

namespace coppice {

namespace {

using google::protobuf::io::CodedInputStream;
using google::protobuf::io::CodedOutputStream;
using google::protobuf::io::StringOutputStream;

// The encoding of Protobuf (protobuf.dev/programming-guides/encoding): a field is a tag, which holds its
// number and the type of its value, and the value. Fields that are 0 or empty are left out.

constexpr std::uint32_t varint = 0;
constexpr std::uint32_t eight_octets = 1;
constexpr std::uint32_t with_length = 2;
constexpr std::uint32_t four_octets = 5;

using Octets = std::vector<std::uint8_t>;
template <class T>
constexpr bool has_fields = requires {
  Fields<T>::list;
};
template <class T>
constexpr bool is_number = std::is_integral_v<T> || std::is_enum_v<T>;

// --- writing ---

void put_tag(int number, std::uint32_t type, CodedOutputStream& out) {
  out.WriteTag(static_cast<std::uint32_t>(number) << 3 | type);
}

void put_bytes(int number, const void* bytes, std::size_t size, CodedOutputStream& out) {
  put_tag(number, with_length, out);
  out.WriteVarint32(static_cast<std::uint32_t>(size));
  out.WriteRaw(bytes, static_cast<int>(size));
}

template <class T>
void put_fields(const T& value, CodedOutputStream& out);

template <class T>
std::string encoded(const T& value) {
  std::string bytes;
  StringOutputStream stream(&bytes);
  CodedOutputStream out(&stream);
  put_fields(value, out);
  out.Trim();
  return bytes;
}

/// Negative numbers are folded in between the others ("sint32").
std::uint64_t as_varint(std::int32_t number) {
  return (static_cast<std::uint32_t>(number) << 1) ^ static_cast<std::uint32_t>(number >> 31);
}
template <class T>
std::uint64_t as_varint(T number) {
  return static_cast<std::uint64_t>(number);
}

template <class T>
void put(int number, const T& value, bool even_if_zero, CodedOutputStream& out) {
  if constexpr (has_fields<T>) {
    const std::string bytes = encoded(value);
    put_bytes(number, bytes.data(), bytes.size(), out);
  } else if constexpr (std::is_same_v<T, double>) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    if (bits == 0 && !even_if_zero) return;
    put_tag(number, eight_octets, out);
    out.WriteLittleEndian64(bits);
  } else if constexpr (is_number<T>) {
    if (as_varint(value) == 0 && !even_if_zero) return;
    put_tag(number, varint, out);
    out.WriteVarint64(as_varint(value));
  } else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, Octets>) {
    if (!value.empty() || even_if_zero) put_bytes(number, value.data(), value.size(), out);
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    if (value.empty()) return;
    static_assert(std::endian::native == std::endian::little);
    put_bytes(number, value.data(), 8 * value.size(), out);
  } else {
    for (const auto& element : value) put(number, element, true, out);
  }
}

template <class T>
void put_fields(const T& value, CodedOutputStream& out) {
  std::apply([&](const auto&... f) { (put(f.number, f.member(value), f.may_be_absent, out), ...); },
             Fields<T>::list);
}

// --- reading ---

bool skip(std::uint32_t type, CodedInputStream& in) {
  std::uint64_t number = 0;
  std::uint32_t half = 0;
  std::uint32_t size = 0;
  switch (type) {
    case varint:
      return in.ReadVarint64(&number);
    case eight_octets:
      return in.ReadLittleEndian64(&number);
    case with_length:
      return in.ReadVarint32(&size) && size <= INT32_MAX && in.Skip(static_cast<int>(size));
    case four_octets:
      return in.ReadLittleEndian32(&half);
    default:
      return false;
  }
}

bool take_bytes(std::string& bytes, CodedInputStream& in) {
  std::uint32_t size = 0;
  return in.ReadVarint32(&size) && size <= INT32_MAX && in.ReadString(&bytes, static_cast<int>(size));
}

template <class T>
T from_varint(std::uint64_t number) {
  if constexpr (std::is_same_v<T, std::int32_t>) {
    const auto folded = static_cast<std::uint32_t>(number);
    return static_cast<std::int32_t>((folded >> 1) ^ (~(folded & 1) + 1));
  } else if constexpr (std::is_same_v<T, bool>) {
    return number != 0;
  } else if constexpr (sizeof(T) == 1) {  // 255 is no enumerator
    return static_cast<T>(static_cast<std::uint8_t>(std::min<std::uint64_t>(number, 255)));
  } else {
    return static_cast<T>(number);
  }
}

template <class T>
bool take_fields(T& value, CodedInputStream& in);

/// The type of a value on the wire.
template <class T>
constexpr std::uint32_t wire_type = std::is_same_v<T, double> ? eight_octets
                                    : is_number<T>            ? varint
                                                              : with_length;

template <class T>
bool take(T& value, CodedInputStream& in) {
  if constexpr (has_fields<T>) {
    std::uint32_t size = 0;
    if (!in.ReadVarint32(&size) || size > INT32_MAX) return false;
    const int left = in.BytesUntilLimit();  // of the message around it; -1: there is none
    if (left >= 0 && static_cast<int>(size) > left) return false;
    const CodedInputStream::Limit before = in.PushLimit(static_cast<int>(size));
    const bool complete = take_fields(value, in) && in.BytesUntilLimit() == 0;
    in.PopLimit(before);
    return complete;
  } else if constexpr (std::is_same_v<T, double>) {
    std::uint64_t bits = 0;
    if (!in.ReadLittleEndian64(&bits)) return false;
    value = std::bit_cast<double>(bits);
    return true;
  } else if constexpr (is_number<T>) {
    std::uint64_t number = 0;
    if (!in.ReadVarint64(&number)) return false;
    value = from_varint<T>(number);
    return true;
  } else if constexpr (std::is_same_v<T, std::string>) {
    return take_bytes(value, in);
  } else if constexpr (std::is_same_v<T, Octets>) {
    std::string bytes;
    if (!take_bytes(bytes, in)) return false;
    value.assign(bytes.begin(), bytes.end());
    return true;
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    std::string bytes;
    if (!take_bytes(bytes, in) || bytes.size() % 8 != 0) return false;
    const std::size_t before = value.size();
    value.resize(before + bytes.size() / 8);
    bytes.copy(reinterpret_cast<char*>(value.data() + before), bytes.size());
    return true;
  } else {
    return take(value.emplace_back(), in);
  }
}

/// A field that is left out is 0 or empty, whatever the struct's own default is.
template <class T>
void clear(T& value) {
  if constexpr (has_fields<T>) {
    const auto each = [&](const auto&... f) { ((f.may_be_absent ? void() : clear(f.member(value))), ...); };
    std::apply(each, Fields<T>::list);
  } else {
    value = T{};
  }
}

/// Reads to the end, or to the limit.
template <class T>
bool take_fields(T& value, CodedInputStream& in) {
  clear(value);
  while (const std::uint32_t tag = in.ReadTag()) {
    const auto number = static_cast<int>(tag >> 3);
    const std::uint32_t type = tag & 7;
    bool valid = true;
    const auto is_it = [&](const auto& f) {
      auto& member = f.member(value);
      if (f.number != number || type != wire_type<std::remove_cvref_t<decltype(member)>>) return false;
      valid = take(member, in);
      return true;
    };
    const bool known = std::apply([&](const auto&... f) { return (is_it(f) || ...); }, Fields<T>::list);
    if (!known) valid = skip(type, in);
    if (!valid) return false;
  }
  return in.ConsumedEntireMessage();
}

template <class M>
std::optional<Message> parsed(std::string_view bytes) {
  CodedInputStream in(reinterpret_cast<const std::uint8_t*>(bytes.data()), static_cast<int>(bytes.size()));
  typename WireForm<M>::Type message{};
  if (!take_fields(message, in)) return std::nullopt;
  return from_wire_form(std::move(message));
}

}  // namespace

std::string channel_name(TopicNumber topic) {
  return "/coppice/" + std::string(topic_infos.at(topic).name);
}

std::uint64_t nanoseconds(WallTime at) {
  constexpr double latest = 9e18;
  return static_cast<std::uint64_t>(std::llround(std::clamp(1e9 * at, 0.0, latest)));
}
WallTime wall_time(std::uint64_t nanoseconds) {
  return 1e-9 * static_cast<double>(nanoseconds);
}

std::string recorded(const Message& message) {
  return std::visit([](const auto& m) { return encoded(wire_form(m)); }, message);
}

std::optional<Message> message_in(TopicNumber topic, std::string_view bytes) {
  if (bytes.size() > largest_recorded(topic)) return std::nullopt;
  return []<class... Ms>(TopicNumber number, std::string_view data, const std::variant<Ms...>*) {
    constexpr std::array<std::optional<Message> (*)(std::string_view), topic_count> parsers{parsed<Ms>...};
    return parsers.at(number)(data);
  }(topic, bytes, static_cast<const Message*>(nullptr));
}

}  // namespace coppice
