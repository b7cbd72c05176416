// Messages that leave over a WebSocket.
#pragma once

#include <memory>
#include <string>

namespace coppice {

/// Encoded once, and shared by all receivers.
using Payload = std::shared_ptr<const std::string>;

struct Outbound {
  Payload bytes;
  bool text = false;
};

}  // namespace coppice
