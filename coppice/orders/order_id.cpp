#include "coppice/orders/order_id.h"

#include <random>

#include <fmt/format.h>

namespace coppice {

std::string draw_order_id() {
  std::random_device device;
  return fmt::format("{:08x}{:08x}", device(), device());
}

}  // namespace coppice
