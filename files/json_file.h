// Strict reader of JSON files (RFC 8259) into Protobuf messages: a number field takes only numbers, and
// unknown fields are errors. Protobuf's own reader takes "12" for a number, and commas before brackets.
#pragma once

#include <filesystem>

#include <google/protobuf/message.h>

namespace coppice {

/// Supports fields of doubles, uint32, strings, booleans, messages and lists of them. Throws InputError,
/// which names the file, the line and the field, and what was expected.
void read_json(const std::filesystem::path& path, google::protobuf::Message& message);

}  // namespace coppice
