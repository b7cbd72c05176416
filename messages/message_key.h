// Which messages of a topic replace each other: the keys of idl/fleet.idl.
#pragma once

#include <string>

#include "messages/messages.h"

namespace coppice {

/// Within the message's topic.
std::string key_of(const Message& message);

}  // namespace coppice
