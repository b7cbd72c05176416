// Texts that statuses carry: lists of names in few words, and no text longer than a message holds.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "messages/messages.h"
#include "messages/validation.h"

namespace coppice {

/// The text, or as much of its beginning as a status holds. Never cuts a character of UTF-8.
inline std::string bounded(std::string text) {
  if (text.size() <= longest_reason) return text;
  std::size_t end = longest_reason;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0u) == 0x80) --end;
  text.resize(end);
  return text;
}

/// The order in which people count: r2 comes before r10.
inline bool counts_before(const RobotName& a, const RobotName& b) {
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

/// "r1", "r1 and r2", "r1, r2 and 6 more"; "nobody" if there is none.
inline std::string listed(std::vector<RobotName> robots) {
  std::ranges::sort(robots, counts_before);
  if (robots.empty()) return "nobody";
  if (robots.size() == 1) return robots[0];
  if (robots.size() == 2) return fmt::format("{} and {}", robots[0], robots[1]);
  return fmt::format("{}, {} and {} more", robots[0], robots[1], robots.size() - 2);
}

}  // namespace coppice
