#include "motion/cluster_roadmap.h"

#include <algorithm>

namespace coppice {

ClusterRoadmap::ClusterRoadmap(PackedRoadmap& packed, std::span<const JointTask> tasks,
                               std::span<const Point2> more) {
  std::vector<Point2> added;
  const auto vertex_at = [&](const Point2& p) {
    const auto known = std::ranges::find(added, p);
    const auto vertex = static_cast<Vertex>(packed.size()) + static_cast<Vertex>(known - added.begin());
    if (known == added.end()) added.push_back(p);
    return vertex;
  };
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const JointTask& task = tasks[i];
    if (!task.movable) continue;
    robots.push_back(i);
    const Vertex start = vertex_at(task.position);
    their_tasks.push_back({start, task.goal ? std::optional(vertex_at(*task.goal)) : std::nullopt});
  }
  for (const Point2& p : more) vertex_at(p);
  graph = packed.with(added, immovable(tasks));
}

std::vector<Move> ClusterRoadmap::paths_of(std::span<const VertexMove> moves) const {
  std::vector<Move> paths;
  for (const VertexMove& move : moves)
    paths.push_back({robots[move.robot], graph.edges(move.from)[move.edge].path});
  return paths;
}

}  // namespace coppice
