#include "dds/conversion.h"

#include <cstdint>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "messages/fields.h"

namespace coppice {

namespace {

// put() writes a value to its field in a DDS type, and take() reads it. A struct is written field by field.

template <class T, class InDds>
void put(const T& value, InDds&& field);
template <class T, class Element>
void put(const std::vector<T>& values, std::vector<Element>& field);
template <class T, class InDds>
void take(T& value, const InDds& field);
template <class T, class Element>
void take(std::vector<T>& values, const std::vector<Element>& field);

void put(const RobotName& robot, idl::RobotId& id) {
  id.robot(robot);
}
void take(RobotName& robot, const idl::RobotId& id) {
  robot = id.robot().to_string();
}

template <class T, class Element>
void put(const std::vector<T>& values, std::vector<Element>& field) {
  field.resize(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) put(values[k], field[k]);
}
template <class T, class Element>
void take(std::vector<T>& values, const std::vector<Element>& field) {
  values.resize(field.size());
  for (std::size_t k = 0; k < values.size(); ++k) take(values[k], field[k]);
}

template <class T, class InDds>
void put(const T& value, InDds&& field) {
  if constexpr (requires { Fields<T>::list; }) {
    const auto each = [&](const auto&... f) { (put(f.member(value), f.in_dds(field)), ...); };
    std::apply(each, Fields<T>::list);
  } else if constexpr (std::is_enum_v<T>) {
    field = static_cast<std::uint8_t>(value);
  } else {
    field = value;
  }
}
template <class T, class InDds>
void take(T& value, const InDds& field) {
  if constexpr (requires { Fields<T>::list; }) {
    const auto each = [&](const auto&... f) { (take(f.member(value), f.in_dds(field)), ...); };
    std::apply(each, Fields<T>::list);
  } else if constexpr (std::is_same_v<T, std::string>) {
    value = field.to_string();
  } else {
    value = static_cast<T>(field);
  }
}

template <class M, class Sample>
Sample to_sample(const M& message) {
  Sample sample;
  put(wire_form(message), sample);
  return sample;
}
template <class M, class Sample>
M from_sample(const Sample& sample) {
  typename WireForm<M>::Type message{};
  take(message, sample);
  return from_wire_form(std::move(message));
}

}  // namespace

#define COPPICE_CONVERSIONS(MESSAGE, TYPE)         \
  idl::TYPE to_dds(const MESSAGE& message) {       \
    return to_sample<MESSAGE, idl::TYPE>(message); \
  }                                                \
  MESSAGE from_dds(const idl::TYPE& sample) {      \
    return from_sample<MESSAGE>(sample);           \
  }
COPPICE_DDS_TYPES(COPPICE_CONVERSIONS)
#undef COPPICE_CONVERSIONS

}  // namespace coppice
