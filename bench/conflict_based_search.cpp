#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <tuple>

#include "bench/centralised.h"

namespace coppice {

namespace {

constexpr std::size_t most_robots_of_cbs = 20;
constexpr int infinity = std::numeric_limits<int>::max() / 2;

using Cell = int;                 ///< row by row
using Steps = std::vector<Cell>;  ///< the cell of a robot at each time; it stays at the last one

/// A robot may not be at `to` at a time, or, if `from` is another cell, not come from there to there then.
struct Constraint {
  int time;
  Cell from;
  Cell to;
  auto operator<=>(const Constraint&) const = default;
};
using Constraints = std::set<Constraint>;

struct Grid {
  explicit Grid(const OccupancyMap& of) : map(of) {}

  template <class Fn>
  void for_each_neighbour(Cell cell, Fn&& fn) const {
    const int i = cell % map.width;
    const int j = cell / map.width;
    for (const auto& [x, y] :
         {std::pair(i + 1, j), std::pair(i - 1, j), std::pair(i, j + 1), std::pair(i, j - 1)}) {
      if (!map.is_blocked(x, y)) fn(y * map.width + x);
    }
  }
  /// Steps from each cell to the goal; infinity where it cannot be reached.
  std::vector<int> distances(Cell goal) const {
    std::vector<int> distance(map.blocked.size(), infinity);
    distance[static_cast<std::size_t>(goal)] = 0;
    std::queue<Cell> open({goal});
    for (; !open.empty(); open.pop()) {
      const int next = distance[static_cast<std::size_t>(open.front())] + 1;
      for_each_neighbour(open.front(), [&](Cell c) {
        if (distance[static_cast<std::size_t>(c)] <= next) return;
        distance[static_cast<std::size_t>(c)] = next;
        open.push(c);
      });
    }
    return distance;
  }
  const OccupancyMap& map;
};

/// The shortest way under constraints, by A* over cells and times. Empty if there is none.
Steps shortest(const Grid& grid, Cell start, Cell goal, const std::vector<int>& distance,
               const Constraints& constraints) {
  if (distance[static_cast<std::size_t>(start)] == infinity) return {};
  int last = 0;          // time of the last constraint
  int last_at_goal = 0;  // before that the robot may not stay at the goal
  for (const Constraint& c : constraints) {
    last = std::max(last, c.time);
    if (c.from == c.to && c.to == goal) last_at_goal = std::max(last_at_goal, c.time + 1);
  }
  using Key = std::pair<int, Cell>;  // later times are one time, once no constraint is left
  std::map<Key, Key> parents;
  std::priority_queue<std::tuple<int, int, Cell>, std::vector<std::tuple<int, int, Cell>>, std::greater<>>
      open;
  const auto offer = [&](Cell cell, int time, Key parent) {
    if (constraints.contains({time, cell, cell})) return;
    if (time > 0 && constraints.contains({time, parent.second, cell})) return;
    if (distance[static_cast<std::size_t>(cell)] == infinity) return;
    if (!parents.emplace(Key{time, cell}, parent).second) return;
    const int estimate = std::max(time + distance[static_cast<std::size_t>(cell)], last_at_goal);
    open.emplace(estimate, -time, cell);
  };
  offer(start, 0, {-1, start});
  while (!open.empty()) {
    const auto [estimate, later, cell] = open.top();
    const int time = -later;
    open.pop();
    if (cell == goal && time >= last_at_goal) {
      Steps steps;
      for (Key at{time, cell}; at.first >= 0; at = parents.at(at)) steps.push_back(at.second);
      std::ranges::reverse(steps);
      return steps;
    }
    if (time <= last) offer(cell, time + 1, {time, cell});  // later than that, nobody waits
    grid.for_each_neighbour(cell, [&](Cell next) { offer(next, time + 1, {time, cell}); });
  }
  return {};
}

Cell at(const Steps& steps, int time) {
  return steps[std::min(static_cast<std::size_t>(time), steps.size() - 1)];
}

struct Conflict {
  std::size_t a;
  std::size_t b;
  Constraint of_a;
  Constraint of_b;
};

/// The first conflict in time, and how many there are.
std::pair<std::optional<Conflict>, int> conflicts(const std::vector<Steps>& plan) {
  std::optional<Conflict> first;
  int count = 0;
  const auto meet = [&](const Conflict& conflict) {
    ++count;
    if (!first || conflict.of_a.time < first->of_a.time) first = conflict;
  };
  for (std::size_t a = 0; a < plan.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const int end = static_cast<int>(std::max(plan[a].size(), plan[b].size()));
      for (int t = 0; t < end; ++t) {
        const Cell x = at(plan[a], t);
        const Cell y = at(plan[b], t);
        if (x == y) meet({a, b, {t, x, x}, {t, x, x}});
        if (t == 0) continue;
        const Cell u = at(plan[a], t - 1);
        const Cell v = at(plan[b], t - 1);
        if (x == v && y == u && x != y) meet({a, b, {t, u, x}, {t, v, y}});
      }
    }
  }
  return {first, count};
}

struct Node {
  int cost = 0;
  int conflicts = 0;
  std::size_t number = 0;
  std::vector<Steps> plan{};
  std::vector<Constraints> constraints{};
  std::optional<Conflict> conflict{};
  bool operator>(const Node& other) const {
    return std::tie(cost, conflicts, number) > std::tie(other.cost, other.conflicts, other.number);
  }
};

/// Counts the arrivals and the conflicts.
void judge(Node& node) {
  node.cost = 0;
  for (const Steps& steps : node.plan) node.cost += static_cast<int>(steps.size()) - 1;
  std::tie(node.conflict, node.conflicts) = conflicts(node.plan);
}

/// The cell in whose centre a point lies; nothing if it lies elsewhere.
std::optional<Cell> cell_of(const OccupancyMap& map, const Point2& p) {
  const Point2 q = (p - map.origin) / map.resolution - Point2(0.5, 0.5);
  if ((q - Point2(q.array().round())).norm() > 1e-6) return std::nullopt;
  return static_cast<int>(std::lround(q.y())) * map.width + static_cast<int>(std::lround(q.x()));
}

}  // namespace

bool is_for_conflict_based_search(const Scenario& scenario) {
  const std::vector<RobotTask>& robots = scenario.robots;
  return robots.size() <= most_robots_of_cbs && std::ranges::all_of(robots, [&](const RobotTask& robot) {
           return cell_of(scenario.map, robot.start) && cell_of(scenario.map, robot.goal) &&
                  robot.radius <= scenario.map.resolution / 2 && robot.max_speed == robots[0].max_speed;
         });
}

std::optional<ReferenceFigures> conflict_based_search(const Scenario& scenario, std::size_t most_nodes) {
  const OccupancyMap& map = scenario.map;
  const std::vector<RobotTask>& robots = scenario.robots;
  const Grid grid(map);
  std::vector<std::pair<Cell, Cell>> ends;
  std::vector<std::vector<int>> distances;
  for (const RobotTask& robot : robots) {
    ends.emplace_back(cell_of(map, robot.start).value(), cell_of(map, robot.goal).value());
    distances.push_back(grid.distances(ends.back().second));
  }
  Node root{.constraints = std::vector<Constraints>(robots.size())};
  for (std::size_t k = 0; k < robots.size(); ++k) {
    root.plan.push_back(shortest(grid, ends[k].first, ends[k].second, distances[k], {}));
    if (root.plan.back().empty()) return std::nullopt;
  }
  judge(root);
  std::priority_queue<Node, std::vector<Node>, std::greater<>> open;
  open.push(std::move(root));
  std::size_t number = 0;
  while (!open.empty() && number < most_nodes) {
    const Node node = open.top();
    open.pop();
    if (!node.conflict) {
      const double step = map.resolution / robots[0].max_speed;
      std::size_t last = 0;
      for (const Steps& steps : node.plan) last = std::max(last, steps.size() - 1);
      return ReferenceFigures{
          .planner = "CBS", .sum = step * node.cost, .last = step * static_cast<double>(last)};
    }
    for (const auto& [robot, constraint] : {std::pair(node.conflict->a, node.conflict->of_a),
                                            std::pair(node.conflict->b, node.conflict->of_b)}) {
      Node child = node;
      child.number = ++number;
      child.constraints[robot].insert(constraint);
      child.plan[robot] =
          shortest(grid, ends[robot].first, ends[robot].second, distances[robot], child.constraints[robot]);
      if (child.plan[robot].empty()) continue;
      judge(child);
      open.push(std::move(child));
    }
  }
  return std::nullopt;
}

}  // namespace coppice
