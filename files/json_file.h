// Strict reader of JSON files (RFC 8259) into Protobuf messages: a number field takes only numbers, and
// unknown fields are errors. Protobuf's own reader takes "12" for a number, and commas before brackets.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <google/protobuf/message.h>

namespace coppice {

/// Supports fields of doubles, uint32, int32, booleans, strings, messages, and lists of the last two. Throws
/// InputError, which names the file, the line and the field, and what was expected.
void read_json(const std::filesystem::path& path, google::protobuf::Message& message);

/// The same for a text that is no file. Messages call it `name`. A field that is null counts as absent.
void read_json_text(std::string_view text, const std::string& name, google::protobuf::Message& message);

}  // namespace coppice
