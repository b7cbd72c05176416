// Messages as bytes for files: the index of the type in `Message`, then the sample as DDS sends it (CDR).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "messages/messages.h"

namespace coppice {

std::vector<std::uint8_t> serialized(const Message& message);

/// Returns nothing if the bytes are no message, or a message that fails validation (messages/validation.h).
std::optional<Message> deserialized(std::span<const std::uint8_t> bytes);

}  // namespace coppice
