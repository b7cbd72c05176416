#include "planner_service/orders/order_words.h"

#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace coppice {

std::string sender_of(const OrderMessage& order) {
  return " by " + (order.by.empty() ? "somebody who gave no name" : order.by);
}

std::string sentence_of(const std::vector<RobotName>& robots, const char* verb, const char* rest) {
  constexpr std::size_t most_named = 2;
  if (robots.empty()) return {};
  if (robots.size() == 1) return fmt::format("{} {} {}", robots.front(), verb, rest);
  const std::vector<RobotName> named(robots.begin(), robots.begin() + most_named);
  const std::size_t more = robots.size() - most_named;
  const std::string others = more > 0 ? fmt::format(" and {} more", more) : std::string();
  return fmt::format("{}{}: each {} {}", fmt::join(named, ", "), others, verb, rest);
}

std::string reason_of(const OrderMessage& cancellation) {
  return fmt::format("cancelled{}{}{}", sender_of(cancellation), cancellation.why.empty() ? "" : ": ",
                     cancellation.why);
}

}  // namespace coppice
