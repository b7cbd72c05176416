#include "bench/grid_a_star.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

namespace coppice {

GridAStar::GridAStar(const ClearanceField& field) : field_(field) {}

Path GridAStar::path(const Point2& start, const Point2& goal, double radius) {
  const GridFrame& frame = field_.frame();
  const std::size_t cells = frame.cells();
  cost_.assign(cells, std::numeric_limits<float>::infinity());
  parent_.assign(cells, -1);
  closed_.assign(cells, 0);
  const auto cell_of = [&](const Point2& p) {
    const Point2 q = (p - frame.origin) / frame.resolution;
    return std::clamp(static_cast<int>(q.y()), 0, frame.height - 1) * frame.width +
           std::clamp(static_cast<int>(q.x()), 0, frame.width - 1);
  };
  const auto centre = [&](int c) {
    return Point2(frame.origin + frame.resolution * Point2(c % frame.width + 0.5, c / frame.width + 0.5));
  };
  const int from = cell_of(start);
  const int to = cell_of(goal);
  const auto is_free = [&](int c) { return c == from || c == to || field_.is_free(centre(c), radius); };
  const auto place = [&](int c) { return c == from ? start : c == to ? goal : centre(c); };
  const auto estimate = [&](int c) {  // octile distance, in cells
    const int dx = std::abs(c % frame.width - to % frame.width);
    const int dy = std::abs(c / frame.width - to / frame.width);
    return static_cast<float>(std::max(dx, dy) + (std::numbers::sqrt2 - 1) * std::min(dx, dy));
  };
  using Entry = std::pair<float, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost_[static_cast<std::size_t>(from)] = 0;
  open.emplace(estimate(from), from);
  while (!open.empty()) {
    const int c = open.top().second;
    open.pop();
    if (std::exchange(closed_[static_cast<std::size_t>(c)], 1) != 0) continue;
    ++expanded_;
    if (c == to) break;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = c % frame.width + dx;
        const int y = c / frame.width + dy;
        if ((dx == 0 && dy == 0) || x < 0 || y < 0 || x >= frame.width || y >= frame.height) continue;
        const int next = y * frame.width + x;
        const float through =
            cost_[static_cast<std::size_t>(c)] + (dx != 0 && dy != 0 ? std::numbers::sqrt2_v<float> : 1.0f);
        if (through >= cost_[static_cast<std::size_t>(next)]) continue;
        if (!is_free(next)) continue;
        const bool is_diagonal = dx != 0 && dy != 0;
        if (is_diagonal && !(is_free(c + dx) && is_free(c + dy * frame.width))) continue;
        if ((c == from || next == to) && !field_.segment_free(place(c), place(next), radius)) continue;
        cost_[static_cast<std::size_t>(next)] = through;
        parent_[static_cast<std::size_t>(next)] = c;
        open.emplace(through + estimate(next), next);
      }
    }
  }
  Path points;
  if (closed_[static_cast<std::size_t>(to)] == 0) return points;
  points.push_back(goal);
  for (int c = to; c != -1; c = parent_[static_cast<std::size_t>(c)]) {
    if (c != to && c != from) points.push_back(centre(c));
  }
  points.push_back(start);
  std::ranges::reverse(points);
  return points;
}

}  // namespace coppice
