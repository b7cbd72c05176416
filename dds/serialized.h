// Messages as bytes, for disks: the topic's place in `Message`, then the sample as DDS sends it (CDR).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "messages/messages.h"

namespace coppice {

std::vector<std::uint8_t> serialized(const Message& message);

/// Nothing if the bytes are no message, or one that no role would accept (validation.h).
std::optional<Message> deserialized(std::span<const std::uint8_t> bytes);

}  // namespace coppice
