#include "files/json_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <rapidjson/error/en.h>
#include <rapidjson/memorystream.h>
#include <rapidjson/reader.h>

#include "coppice/files/input_error.h"
#include "files/text_file.h"
#include "planning/nearest_name.h"

namespace coppice {

namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

std::string did_you_mean(std::string_view misspelt, const Descriptor& type) {
  std::vector<std::string> names;
  for (int i = 0; i < type.field_count(); ++i) names.push_back(type.field(i)->name());
  const std::string nearest = nearest_name(misspelt, names);
  return nearest.empty() ? "" : fmt::format(" (did you mean {}?)", nearest);
}

std::string names_of_fields(const Descriptor& type, std::string_view format, std::string_view between) {
  std::string names;
  for (int i = 0; i < type.field_count(); ++i) {
    if (i > 0) names += between;
    names += fmt::format(fmt::runtime(format), type.field(i)->name());
  }
  return names;
}

std::string object_of(const Descriptor& type) {
  return "{" + names_of_fields(type, "\"{}\": ...", ", ") + "}";
}

/// Describes the expected value of a field for messages. `in_list`: describes one element of a list.
std::string expected_of(const FieldDescriptor& field, bool in_list) {
  if (field.is_repeated() && !in_list) return "a list [...]";
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return "a number";
    case FieldDescriptor::CPPTYPE_UINT32:
      return fmt::format("a whole number from 0 to {}", std::numeric_limits<std::uint32_t>::max());
    case FieldDescriptor::CPPTYPE_INT32:
      return fmt::format("a whole number from {} to {}", std::numeric_limits<std::int32_t>::min(),
                         std::numeric_limits<std::int32_t>::max());
    case FieldDescriptor::CPPTYPE_BOOL:
      return "true or false";
    case FieldDescriptor::CPPTYPE_STRING:
      return "a text in quotes";
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return object_of(*field.message_type());
    default:
      throw std::logic_error("no file has a field of this kind: " + field.full_name());
  }
}

/// Whether a number is a value of this integer type.
template <class Integer>
bool is_one(double value) {
  return value >= std::numeric_limits<Integer>::min() && value <= std::numeric_limits<Integer>::max() &&
         value == std::floor(value);
}

/// Whether a field may be null.
enum class NullMeaning : unsigned char { refused, absent };

/// Fills a message from the parser's events. Each function returns false if the event does not fit the
/// message; then problem() says why.
class MessageBuilder : public rapidjson::BaseReaderHandler<rapidjson::UTF8<>, MessageBuilder> {
 public:
  MessageBuilder(Message& message, NullMeaning null) : root_(message), null_(null) {}

  const std::string& problem() const { return problem_; }
  /// The field that is being read: "robots[2].start.x: ". Empty outside of all fields.
  std::string place() const {
    const std::string text = field();
    return text.empty() ? text : text + ": ";
  }

  bool Null() {
    const bool is_a_field = !levels_.empty() && !levels_.back().in_list;
    return (is_a_field && null_ == NullMeaning::absent) || refuse("null");
  }
  bool Bool(bool value) {
    if (!is_due(FieldDescriptor::CPPTYPE_BOOL)) return refuse(value ? "true" : "false");
    return set([&](Message& m, const FieldDescriptor* f) { m.GetReflection()->SetBool(&m, f, value); });
  }
  bool Int(int value) { return Double(value); }
  bool Uint(unsigned value) { return Double(value); }
  bool Int64(std::int64_t value) { return Double(static_cast<double>(value)); }
  bool Uint64(std::uint64_t value) { return Double(static_cast<double>(value)); }
  bool Double(double value) {
    if (is_due(FieldDescriptor::CPPTYPE_DOUBLE))
      return set([&](Message& m, const FieldDescriptor* f) { m.GetReflection()->SetDouble(&m, f, value); });
    if (is_due(FieldDescriptor::CPPTYPE_UINT32) && is_one<std::uint32_t>(value))
      return set([&](Message& m, const FieldDescriptor* f) {
        m.GetReflection()->SetUInt32(&m, f, static_cast<std::uint32_t>(value));
      });
    if (is_due(FieldDescriptor::CPPTYPE_INT32) && is_one<std::int32_t>(value))
      return set([&](Message& m, const FieldDescriptor* f) {
        m.GetReflection()->SetInt32(&m, f, static_cast<std::int32_t>(value));
      });
    return refuse(fmt::format("{}", value));
  }
  bool String(const char* text, rapidjson::SizeType length, bool) {
    if (!is_due(FieldDescriptor::CPPTYPE_STRING)) return refuse("a text");
    set([&](Message& m, const FieldDescriptor* f) {
      const std::string value(text, length);
      f->is_repeated() ? m.GetReflection()->AddString(&m, f, value)
                       : m.GetReflection()->SetString(&m, f, value);
    });
    count_element();
    return true;
  }

  bool StartObject() {
    if (levels_.empty()) {
      levels_.push_back({&root_});
      return true;
    }
    if (!is_due(FieldDescriptor::CPPTYPE_MESSAGE)) return refuse("an object");
    Level& level = levels_.back();
    const auto* reflection = level.message->GetReflection();
    Message* const inner = level.in_list ? reflection->AddMessage(level.message, level.field)
                                         : reflection->MutableMessage(level.message, level.field);
    levels_.push_back({inner});
    return true;
  }
  bool Key(const char* text, rapidjson::SizeType length, bool) {
    const std::string name(text, length);
    Level& level = levels_.back();
    const Descriptor& type = *level.message->GetDescriptor();
    level.field = type.FindFieldByName(name);
    if (level.field == nullptr) level.field = type.FindFieldByCamelcaseName(name);
    if (level.field == nullptr) {
      return fail(fmt::format("{}\"{}\" is not a field{}, expected one of {}", place(), printable(name),
                              did_you_mean(name, type), names_of_fields(type, "{}", ", ")));
    }
    if (!level.given.insert(level.field).second) return fail(place() + "is given twice");
    return true;
  }
  bool EndObject(rapidjson::SizeType) {
    levels_.pop_back();
    count_element();
    return true;
  }
  bool StartArray() {
    const bool is_list = !levels_.empty() && levels_.back().field->is_repeated() && !levels_.back().in_list;
    if (!is_list) return refuse("a list");
    levels_.back().in_list = true;
    levels_.back().index = 0;
    return true;
  }
  bool EndArray(rapidjson::SizeType) {
    levels_.back().in_list = false;
    return true;
  }

 private:
  /// A message whose fields are being read.
  struct Level {
    Message* message;
    const FieldDescriptor* field = nullptr;  ///< the field whose value comes next
    bool in_list = false;                    ///< whether that value is an element of a list
    std::size_t index = 0;                   ///< index of the element
    std::set<const FieldDescriptor*> given{};
  };

  bool is_due(FieldDescriptor::CppType type) const {
    if (levels_.empty()) return false;
    const Level& level = levels_.back();
    return level.field->cpp_type() == type && level.field->is_repeated() == level.in_list;
  }

  template <class Fn>
  bool set(Fn&& fn) {
    fn(*levels_.back().message, levels_.back().field);
    return true;
  }

  void count_element() {
    if (!levels_.empty() && levels_.back().in_list) ++levels_.back().index;
  }

  std::string field() const {
    std::string text;
    for (const Level& level : levels_) {
      if (level.field == nullptr) continue;
      text += (text.empty() ? "" : ".") + level.field->name();
      if (level.in_list) text += fmt::format("[{}]", level.index);
    }
    return text;
  }

  static std::string printable(const std::string& name) {
    std::string text = name.substr(0, 40);
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < ' '; }, '?');
    return text;
  }

  bool refuse(std::string_view found) {
    if (levels_.empty())
      return fail(fmt::format("expected {}, found {}", object_of(*root_.GetDescriptor()), found));
    const Level& level = levels_.back();
    return fail(
        fmt::format("{}expected {}, found {}", place(), expected_of(*level.field, level.in_list), found));
  }
  bool fail(std::string problem) {
    problem_ = std::move(problem);
    return false;
  }

  Message& root_;
  NullMeaning null_;
  std::vector<Level> levels_;
  std::string problem_;
};

[[noreturn]] void fail(const std::string& name, std::string_view text, std::size_t at,
                       const std::string& problem) {
  const auto line = 1 + std::ranges::count(text.substr(0, at), '\n');
  throw InputError(fmt::format("{}:{}: {}", name, line, problem));
}

std::string syntax_problem(const rapidjson::ParseResult& result, std::string_view text) {
  const std::size_t at = result.Offset();
  const std::size_t before = text.substr(0, at).find_last_not_of(" \t\r\n");
  const bool closes = at < text.size() && (text[at] == '}' || text[at] == ']');
  if (closes && before != std::string_view::npos && text[before] == ',')
    return fmt::format("a comma before {}, expected none", text[at]);
  return rapidjson::GetParseError_En(result.Code());
}

void read(std::string_view text, const std::string& name, NullMeaning null, Message& message) {
  rapidjson::MemoryStream stream(text.data(), text.size());
  MessageBuilder builder(message, null);
  rapidjson::Reader reader;
  // The parser is iterative, because deeply nested brackets would overflow the stack of a recursive one.
  constexpr unsigned strict = rapidjson::kParseIterativeFlag | rapidjson::kParseFullPrecisionFlag |
                              rapidjson::kParseValidateEncodingFlag;
  const rapidjson::ParseResult result = reader.Parse<strict>(stream, builder);
  if (!builder.problem().empty()) fail(name, text, stream.Tell(), builder.problem());
  if (result.IsError()) fail(name, text, result.Offset(), builder.place() + syntax_problem(result, text));
  if (stream.Tell() != text.size()) fail(name, text, stream.Tell(), "a zero byte");
}

}  // namespace

void read_json(const std::filesystem::path& path, Message& message) {
  read(read_text(path), path.string(), NullMeaning::refused, message);
}

void read_json_text(std::string_view text, const std::string& name, Message& message) {
  read(text, name, NullMeaning::absent, message);
}

}  // namespace coppice
