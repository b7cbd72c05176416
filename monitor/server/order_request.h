// Reads the bodies of API requests: JSON, as idl/orders.proto describes it.
#pragma once

#include <string_view>

#include "messages/orders.h"

namespace coppice {

/// An order to go. Its id is empty if the request names none. Throws InputError, which names line and field.
OrderMessage order_of(std::string_view body, WallTime now);

/// An order to stop, release, pause or resume, without an id. An empty body means all robots. Throws
/// InputError.
OrderMessage halt_order_of(std::string_view body, Action action);

}  // namespace coppice
