// The two ends of a planning problem.
#pragma once

#include <cstdint>

namespace coppice {

/// Each group has two root trees: one is rooted at its start, the other at its goal.
enum class Root : std::uint8_t { start, goal };

constexpr Root partner_of(Root side) {
  return side == Root::start ? Root::goal : Root::start;
}

}  // namespace coppice
