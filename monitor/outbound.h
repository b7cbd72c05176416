// Messages that leave over a WebSocket.
#pragma once

#include <memory>
#include <string>

namespace coppice {

/// Encoded once, and shared by all receivers.
using Bytes = std::shared_ptr<const std::string>;

struct Outbound {
  Bytes bytes;
  bool text = false;
};

}  // namespace coppice
