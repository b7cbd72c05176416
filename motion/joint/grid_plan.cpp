#include "coppice/motion/grid_plan.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "coppice/planning/random.h"
#include "motion/joint/lacam.h"

namespace coppice {

namespace {

constexpr std::size_t configurations_a_search = 10'000;

/// The free cells, each linked to its free neighbours.
struct Grid {
  explicit Grid(const OccupancyMap& map) {
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        if (map.is_blocked(x, y)) continue;
        vertices[{x, y}] = graph.add(Point2(x, y));
        cells.push_back({x, y});
      }
    }
    for (const auto& [cell, from] : vertices) {
      const auto [x, y] = cell;
      for (const auto& next :
           {std::pair(x + 1, y), std::pair(x - 1, y), std::pair(x, y + 1), std::pair(x, y - 1)}) {
        const auto to = vertices.find(next);
        if (to == vertices.end()) continue;
        graph.own_edges(from).push_back({.to = to->second,
                                         .length = 1,
                                         .path = {graph.at(from), graph.at(to->second)},
                                         .near = {to->second}});
      }
    }
  }
  Vertex at(const GridCell& cell, std::size_t robot, const char* end) const {
    const auto known = vertices.find({cell.x, cell.y});
    if (known == vertices.end())
      throw std::invalid_argument("tasks[" + std::to_string(robot) + "]." + end +
                                  " is blocked or not on the map");
    return known->second;
  }

  AnnotatedRoadmap graph{};
  std::map<std::pair<int, int>, Vertex> vertices{};
  std::vector<GridCell> cells{};  ///< by vertex
};

void check_apart(std::set<Vertex>& taken, Vertex vertex, std::size_t robot, const char* end) {
  if (!taken.insert(vertex).second)
    throw std::invalid_argument("tasks[" + std::to_string(robot) + "]." + end +
                                " is that of another robot, too");
}

/// Makes the moves, which are clear one after the other, as early as they are clear.
class Timetable {
 public:
  explicit Timetable(const std::vector<VertexTask>& tasks) {
    for (const VertexTask& task : tasks) steps_.push_back({task.start});
  }

  void make(std::uint32_t robot, Vertex from, Vertex to, const Point2& direction) {
    std::vector<Vertex>& own = steps_[robot];
    std::size_t begin = own.size() - 1;
    if (const auto left = left_.find(to); left != left_.end()) {
      const bool follows = left->second.direction == direction;
      begin = std::max(begin, left->second.step + (follows ? 0 : 1));
    }
    own.resize(begin + 1, from);
    own.push_back(to);
    left_[from] = {begin, direction};
  }
  const std::vector<std::vector<Vertex>>& steps() const { return steps_; }

 private:
  /// The last robot that was in a cell leaves it in this step.
  struct Left {
    std::size_t step;
    Point2 direction;
  };
  std::vector<std::vector<Vertex>> steps_{};  ///< by robot: its vertex at each time
  std::map<Vertex, Left> left_{};
};

}  // namespace

std::optional<GridPlan> plan_on_grid(const OccupancyMap& map, std::span<const GridTask> tasks,
                                     std::uint64_t seed, std::size_t most_configurations) {
  const Grid grid(map);
  std::vector<VertexTask> of_vertices;
  std::set<Vertex> starts;
  std::set<Vertex> goals;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    of_vertices.push_back({grid.at(tasks[k].start, k, "start"), grid.at(tasks[k].goal, k, "goal")});
    check_apart(starts, of_vertices.back().start, k, "start");
    check_apart(goals, *of_vertices.back().goal, k, "goal");
  }
  Cluster cluster(grid.graph, of_vertices);
  if (!cluster.shut_in().empty()) return std::nullopt;
  Lacam lacam(cluster, Random(seed));
  auto progress = SearchState::searching;
  for (std::size_t made = 0; progress == SearchState::searching && made < most_configurations;
       made += configurations_a_search)
    progress = lacam.search(configurations_a_search);
  if (progress != SearchState::solved) return std::nullopt;
  Timetable timetable(of_vertices);
  for (const VertexMove& move : lacam.moves()) {
    const Vertex to = grid.graph.edges(move.from)[move.edge].to;
    timetable.make(move.robot, move.from, to, grid.graph.at(to) - grid.graph.at(move.from));
  }
  GridPlan plan;
  for (const std::vector<Vertex>& steps : timetable.steps()) {
    std::vector<GridCell>& cells = plan.emplace_back();
    for (const Vertex vertex : steps) cells.push_back(grid.cells[vertex]);
  }
  return plan;
}

}  // namespace coppice
