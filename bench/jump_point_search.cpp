#include "bench/jump_point_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

namespace coppice {

JumpPointSearch::Cell JumpPointSearch::cell_at(std::size_t number) const {
  const auto width = static_cast<std::size_t>(field_.frame().width);
  return {static_cast<int>(number % width), static_cast<int>(number / width)};
}

JumpPointSearch::Cell JumpPointSearch::cell_of(const Point2& p) const {
  const GridFrame& frame = field_.frame();
  const Point2 q = (p - frame.origin) / frame.resolution;
  return {std::clamp(static_cast<int>(q.x()), 0, frame.width - 1),
          std::clamp(static_cast<int>(q.y()), 0, frame.height - 1)};
}

/// Where the robot is in a cell.
Point2 JumpPointSearch::place(Cell c) const {
  if (c == start_) return start_place_;
  if (c == goal_) return goal_place_;
  return field_.frame().origin + field_.frame().resolution * Point2(c.x + 0.5, c.y + 0.5);
}

/// The cells of start and goal count as free, although their centres need not be.
bool JumpPointSearch::is_free(Cell c) {
  if (c.x < 0 || c.y < 0 || c.x >= field_.frame().width || c.y >= field_.frame().height) return false;
  if (c == goal_ || c == start_) return true;
  Known& known = known_[number(c)];
  if (known == Known::nothing) known = field_.is_free(place(c), radius_) ? Known::free : Known::blocked;
  return known == Known::free;
}

/// A diagonal step needs both cells beside it.
bool JumpPointSearch::may_step(Cell c, Step step) {
  const Cell next{c.x + step.x, c.y + step.y};
  if (!is_free(next) || !is_free({next.x, c.y}) || !is_free({c.x, next.y})) return false;
  return (c != start_ && next != goal_) || field_.segment_free(place(c), place(next), radius_);
}

/// Whether a neighbour of c is reached best through c, because the way beside c began to be free there.
bool JumpPointSearch::has_forced_neighbour(Cell c, Step step) {
  if (step.x != 0 && step.y != 0) return false;
  return opens(c, step, 1) || opens(c, step, -1);
}

/// Whether the cell at one side of c is free, and the one before it is not. Steps are straight.
bool JumpPointSearch::opens(Cell c, Step step, int side) {
  const Cell beside{c.x + side * step.y, c.y + side * step.x};
  return is_free(beside) && !is_free({beside.x - step.x, beside.y - step.y});
}

/// Whether a straight way from c, on the way of a diagonal step, comes to a jump point.
bool JumpPointSearch::turns_off(Cell c, Step step) {
  if (step.x == 0 || step.y == 0) return false;
  Cell along_x = c;
  Cell along_y = c;
  return jump(along_x, {step.x, 0}) || jump(along_y, {0, step.y});
}

/// Moves c to the next jump point in a direction. Returns false if there is none.
bool JumpPointSearch::jump(Cell& c, Step step) {
  while (true) {
    if (!may_step(c, step)) return false;
    c = {c.x + step.x, c.y + step.y};
    if (c == goal_ || has_forced_neighbour(c, step) || turns_off(c, step)) return true;
  }
}

/// The directions that are not pruned: onwards from the parent, and to forced neighbours.
std::vector<JumpPointSearch::Step> JumpPointSearch::directions(Cell c) {
  std::vector<Step> steps;
  const int parent = parent_[number(c)];
  if (parent < 0) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        if (x != 0 || y != 0) steps.push_back({x, y});
      }
    }
    return steps;
  }
  const Cell from = cell_at(static_cast<std::size_t>(parent));
  const auto sign = [](int v) { return (v > 0) - (v < 0); };
  const Step step{sign(c.x - from.x), sign(c.y - from.y)};
  steps.push_back(step);
  if (step.x != 0 && step.y != 0) {
    steps.push_back({step.x, 0});
    steps.push_back({0, step.y});
    return steps;
  }
  for (const int side : {1, -1}) {
    if (!opens(c, step, side)) continue;
    steps.push_back({side * step.y, side * step.x});
    steps.push_back({step.x + side * step.y, step.y + side * step.x});
  }
  return steps;
}

Path JumpPointSearch::path(const Point2& start, const Point2& goal, double radius) {
  const std::size_t cells = field_.frame().cells();
  if (radius != radius_) known_.assign(cells, Known::nothing);
  radius_ = radius;
  start_place_ = start;
  goal_place_ = goal;
  start_ = cell_of(start);
  goal_ = cell_of(goal);
  cost_.assign(cells, std::numeric_limits<float>::infinity());
  parent_.assign(cells, -1);
  closed_.assign(cells, 0);
  const auto octile = [](Cell a, Cell b) {  // distance, in cells
    const int dx = std::abs(a.x - b.x);
    const int dy = std::abs(a.y - b.y);
    return static_cast<float>(std::max(dx, dy) + (std::numbers::sqrt2 - 1) * std::min(dx, dy));
  };
  using Entry = std::pair<float, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost_[number(start_)] = 0;
  open.emplace(octile(start_, goal_), number(start_));
  while (!open.empty()) {
    const std::size_t n = open.top().second;
    open.pop();
    if (std::exchange(closed_[n], 1) != 0) continue;
    ++expanded_;
    const Cell c = cell_at(n);
    if (c == goal_) break;
    for (const Step step : directions(c)) {
      Cell next = c;
      if (!jump(next, step)) continue;
      const float through = cost_[n] + octile(c, next);
      if (through >= cost_[number(next)]) continue;
      cost_[number(next)] = through;
      parent_[number(next)] = static_cast<int>(n);
      open.emplace(through + octile(next, goal_), number(next));
    }
  }
  if (closed_[number(goal_)] == 0) return {};
  Path points{goal};
  for (int c = parent_[number(goal_)]; c != -1; c = parent_[static_cast<std::size_t>(c)]) {
    if (static_cast<std::size_t>(c) != number(start_))
      points.push_back(place(cell_at(static_cast<std::size_t>(c))));
  }
  points.push_back(start);
  std::ranges::reverse(points);
  return points;
}

}  // namespace coppice
