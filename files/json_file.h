// JSON files that are read into Protobuf messages, strictly: RFC 8259, a number where a number is due, and no
// field that the message has not. Protobuf's own reader takes "12" for a number, and commas before brackets.
#pragma once

#include <filesystem>

#include <google/protobuf/message.h>

namespace coppice {

/// Fields of numbers, texts, truth values, messages and lists of messages. Throws InputError, which names the
/// file, the line and the field, and what was expected.
void read_json(const std::filesystem::path& path, google::protobuf::Message& message);

}  // namespace coppice
