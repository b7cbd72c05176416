// Ids of orders.
#pragma once

#include <string>

namespace coppice {

/// An id that no other order has: 64 random bits.
std::string draw_order_id();

}  // namespace coppice
