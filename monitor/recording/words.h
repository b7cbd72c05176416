// Places, lengths and lists in words.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "coppice/planning/geometry.h"

namespace coppice {

inline std::string place(const Point2& p) {
  // A coordinate that is rounded to 0 has no sign.
  const auto rounded = [](double x) { return std::round(10 * x) / 10 + 0.0; };
  return fmt::format("({:.1f}, {:.1f})", rounded(p.x()), rounded(p.y()));
}

inline std::string metres(double length) {
  return length < 1 ? fmt::format("{:.2f} m", length) : fmt::format("{:.1f} m", length);
}

/// "r1, r2 and 3 more": so many names, and the number of the others.
inline std::string listed(const std::vector<std::string>& names, std::size_t most) {
  const std::size_t shown = std::min(most, names.size());
  const std::string list =
      fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  return shown == names.size() ? list : fmt::format("{} and {} more", list, names.size() - shown);
}

}  // namespace coppice
