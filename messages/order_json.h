// The status of an order as JSON: of the commands, of the HTTP API, and of the history. docs/orders.md lists
// the fields.
#pragma once

#include <string>

#include "messages/orders.h"

namespace coppice {

/// An object in one line. Metres, radians, seconds; times are seconds since the Unix epoch, or null.
std::string json_of(const OrderStatus& status);

}  // namespace coppice
