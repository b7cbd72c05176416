#include "bench/visibility_graph.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

namespace coppice {

namespace {

constexpr int points_an_arc = 3;
constexpr double a_little = 1e-9;  // metres by which vertices keep away from touching

/// Whether a straight way in this direction passes a vertex with its obstacle on one side.
bool is_taut(const Point2& way, const Point2& before, const Point2& after) {
  return cross(way, before) * cross(way, after) >= -a_little;
}

}  // namespace

/// Points around a quarter of a circle. `outwards`: signs of the quadrant into which the corner points.
void VisibilityGraph::add_corner(const Point2& corner, const Point2& outwards, double radius) {
  constexpr double step = std::numbers::pi / 2 / points_an_arc;
  const double reach = (radius + a_little) / std::cos(step / 2);
  const auto turned = [&](double x, double y) { return Point2(outwards.x() * x, outwards.y() * y); };
  for (int k = 0; k < points_an_arc; ++k) {
    const double from = k * step;
    const double middle = from + step / 2;
    const double to = from + step;
    const Point2 place = corner + reach * turned(std::cos(middle), std::sin(middle));
    if (!field_.is_free(place, radius)) continue;
    vertices_.push_back(
        {place, turned(std::sin(from), -std::cos(from)), turned(-std::sin(to), std::cos(to))});
  }
}

void VisibilityGraph::add_vertices(double radius) {
  radius_ = radius;
  vertices_.clear();
  for (int j = 0; j <= map_.height; ++j) {
    for (int i = 0; i <= map_.width; ++i) {
      for (const auto& [x, y] : {std::pair(1, 1), std::pair(1, -1), std::pair(-1, 1), std::pair(-1, -1)}) {
        // The blocked cell lies opposite to the quadrant into which its corner points.
        const int a = x > 0 ? i - 1 : i;
        const int b = y > 0 ? j - 1 : j;
        if (!map_.is_blocked(a, b) || map_.is_blocked(a + x, b) || map_.is_blocked(a, b + y)) continue;
        add_corner(map_.origin + map_.resolution * Point2(i, j), Point2(x, y), radius);
      }
    }
  }
  edges_.assign(vertices_.size(), std::nullopt);
}

bool VisibilityGraph::sees(const Point2& p, const Vertex& v) const {
  const Point2 way = v.place - p;
  return is_taut(way, v.before, v.after) && field_.segment_free(p, v.place, radius_);
}

const std::vector<VisibilityGraph::Edge>& VisibilityGraph::edges(Number n) {
  if (edges_[n]) return *edges_[n];
  const Vertex& v = vertices_[n];
  std::vector<Edge> found;
  for (Number m = 0; m < vertices_.size(); ++m) {
    const Point2 way = vertices_[m].place - v.place;
    if (m != n && is_taut(way, v.before, v.after) && sees(v.place, vertices_[m]))
      found.push_back({m, way.norm()});
  }
  return edges_[n].emplace(std::move(found));
}

Path VisibilityGraph::path(const Point2& start, const Point2& goal, double radius) {
  if (field_.segment_free(start, goal, radius)) return {start, goal};
  if (radius != radius_) add_vertices(radius);
  const auto count = static_cast<Number>(vertices_.size());
  const Number start_number = count;
  const Number goal_number = count + 1;
  std::vector<double> to_goal(count, std::numeric_limits<double>::infinity());  // of vertices that see it
  for (Number v = 0; v < count; ++v) {
    if (sees(goal, vertices_[v])) to_goal[v] = (goal - vertices_[v].place).norm();
  }
  std::vector<double> cost(count + 2, std::numeric_limits<double>::infinity());
  std::vector<Number> parent(count + 2, start_number);
  std::vector<char> closed(count + 2, 0);
  using Entry = std::pair<double, Number>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto offer = [&](Number from, Number to, double through, double rest) {
    if (through >= cost[to]) return;
    cost[to] = through;
    parent[to] = from;
    open.emplace(through + rest, to);
  };
  for (Number v = 0; v < count; ++v) {
    if (sees(start, vertices_[v]))
      offer(start_number, v, (vertices_[v].place - start).norm(), (goal - vertices_[v].place).norm());
  }
  while (!open.empty()) {
    const Number n = open.top().second;
    open.pop();
    if (std::exchange(closed[n], 1) != 0) continue;
    ++expanded_;
    if (n == goal_number) break;
    offer(n, goal_number, cost[n] + to_goal[n], 0);
    for (const Edge& edge : edges(n))
      offer(n, edge.to, cost[n] + edge.length, (goal - vertices_[edge.to].place).norm());
  }
  if (closed[goal_number] == 0) return {};
  Path points{goal};
  for (Number n = parent[goal_number]; n != start_number; n = parent[n]) points.push_back(vertices_[n].place);
  points.push_back(start);
  std::ranges::reverse(points);
  return points;
}

}  // namespace coppice
