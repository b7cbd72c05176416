// The schema of recordings: a Protobuf type for each message, made from the list of fields.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <google/protobuf/descriptor.pb.h>

#include "messages/fields.h"
#include "monitor/recording/recorded_messages.h"

namespace coppice {

namespace {

namespace pb = google::protobuf;
using FieldType = pb::FieldDescriptorProto;

constexpr const char* package = "coppice.recording";

template <class T>
constexpr bool is_list = false;
template <class T>
constexpr bool is_list<std::vector<T>> = true;
template <>
constexpr bool is_list<std::vector<std::uint8_t>> = false;  // bytes

template <class T>
using Bare = std::remove_cvref_t<T>;
template <class T, class F>
using MemberOf = Bare<decltype(std::declval<F>().member(std::declval<T&>()))>;

std::string full_name(std::string_view name) {
  return std::string(package) + "." + std::string(name);
}

bool describes(const pb::FileDescriptorProto& file, std::string_view name) {
  const auto is_it = [&](const auto& type) { return type.name() == name; };
  return std::ranges::any_of(file.message_type(), is_it) || std::ranges::any_of(file.enum_type(), is_it);
}

template <class T>
void describe(pb::FileDescriptorProto& file);

template <class T>
void set_type(FieldType& field, pb::FileDescriptorProto& file) {
  if constexpr (std::is_same_v<T, YAxis> || std::is_same_v<T, bool>) {
    field.set_type(FieldType::TYPE_BOOL);
  } else if constexpr (std::is_same_v<T, double>) {
    field.set_type(FieldType::TYPE_DOUBLE);
  } else if constexpr (std::is_same_v<T, std::uint64_t>) {
    field.set_type(FieldType::TYPE_UINT64);
  } else if constexpr (std::is_same_v<T, std::int32_t>) {
    field.set_type(FieldType::TYPE_SINT32);
  } else if constexpr (std::is_integral_v<T>) {
    field.set_type(FieldType::TYPE_UINT32);
  } else if constexpr (std::is_same_v<T, std::string>) {
    field.set_type(FieldType::TYPE_STRING);
  } else if constexpr (std::is_same_v<T, std::vector<std::uint8_t>>) {
    field.set_type(FieldType::TYPE_BYTES);
  } else if constexpr (std::is_enum_v<T>) {
    field.set_type(FieldType::TYPE_ENUM);
    field.set_type_name("." + full_name(Enumerators<T>::name));
    describe<T>(file);
  } else {
    field.set_type(FieldType::TYPE_MESSAGE);
    field.set_type_name("." + full_name(Fields<T>::name));
    describe<T>(file);
  }
}

template <class T, class F>
void describe_field(const F& f, pb::DescriptorProto& type, pb::FileDescriptorProto& file) {
  FieldType& field = *type.add_field();
  field.set_name(f.name);
  field.set_number(f.number);
  using Member = MemberOf<T, F>;
  if constexpr (is_list<Member>) {
    field.set_label(FieldType::LABEL_REPEATED);
    set_type<typename Member::value_type>(field, file);
  } else {
    field.set_label(FieldType::LABEL_OPTIONAL);
    set_type<Member>(field, file);
  }
  if (!f.may_be_absent) return;
  field.set_proto3_optional(true);
  field.set_oneof_index(type.oneof_decl_size());
  type.add_oneof_decl()->set_name(std::string("_") + f.name);
}

/// Adds the type to the file, with all types that it needs.
template <class T>
void describe(pb::FileDescriptorProto& file) {
  if constexpr (std::is_enum_v<T>) {
    if (describes(file, Enumerators<T>::name)) return;
    pb::EnumDescriptorProto& type = *file.add_enum_type();
    type.set_name(std::string(Enumerators<T>::name));
    for (const char* const value : Enumerators<T>::values) {
      pb::EnumValueDescriptorProto& added = *type.add_value();
      added.set_name(value);
      added.set_number(type.value_size() - 1);
    }
  } else {
    if (describes(file, Fields<T>::name)) return;
    pb::DescriptorProto type;
    type.set_name(std::string(Fields<T>::name));
    std::apply([&](const auto&... f) { (describe_field<T>(f, type, file), ...); }, Fields<T>::list);
    *file.add_message_type() = std::move(type);
  }
}

}  // namespace

std::string schema_name(TopicNumber topic) {
  return []<class... Ms>(TopicNumber number, const std::variant<Ms...>*) {
    const std::array names{Fields<typename WireForm<Ms>::Type>::name...};
    return full_name(names.at(number));
  }(topic, static_cast<const Message*>(nullptr));
}

std::string recorded_schema() {
  pb::FileDescriptorSet files;
  pb::FileDescriptorProto& file = *files.add_file();
  file.set_name("coppice/recording.proto");
  file.set_package(package);
  file.set_syntax("proto3");
  [&]<class... Ms>(const std::variant<Ms...>*) {
    (describe<typename WireForm<Ms>::Type>(file), ...);
  }(static_cast<const Message*>(nullptr));
  return files.SerializeAsString();
}

}  // namespace coppice
