// The robots of a cluster on a roadmap: their tasks, and what each of them still has to drive. All searches
// of a joint plan work on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "motion/lattice/annotated_roadmap.h"
#include "motion/lattice/cost_to_go.h"

namespace coppice {

struct VertexTask {
  Vertex start = 0;
  std::optional<Vertex> goal{};  ///< none: any vertex will do
};

/// A robot drives along one of the edges that lead from a vertex, while all others stand.
struct VertexMove {
  std::uint32_t robot;
  Vertex from;
  std::uint32_t edge;
};

using Configuration = std::vector<Vertex>;  ///< by robot

/// What a bounded amount of search has come to.
enum class SearchState { searching, solved, gave_up };

class Cluster {
 public:
  /// `graph` must outlive it. No two robots start at one vertex. A robot that could not reach its goal even
  /// if it were alone is shut in: it gives way as if it had no goal.
  Cluster(const AnnotatedRoadmap& graph, std::vector<VertexTask> tasks)
      : graph_(graph), tasks_(std::move(tasks)) {
    for (std::uint32_t i = 0; i < tasks_.size(); ++i) {
      auto& [start, goal] = tasks_[i];
      cost_to_go_.emplace_back();
      if (!goal) continue;
      cost_to_go_[i].emplace(graph_, numbers_, *goal, start);
      if (cost(i, start) != unreachable) continue;
      cost_to_go_[i].reset();
      goal.reset();
      shut_in_.push_back(i);
    }
  }
  Cluster(const Cluster&) = delete;  // costs refer to it
  Cluster& operator=(const Cluster&) = delete;
  ~Cluster() = default;

  const AnnotatedRoadmap& graph() const { return graph_; }
  std::size_t size() const { return tasks_.size(); }
  const std::vector<VertexTask>& tasks() const { return tasks_; }
  const std::vector<std::uint32_t>& shut_in() const { return shut_in_; }  ///< ascending
  Configuration starts() const {
    Configuration starts;
    for (const VertexTask& task : tasks_) starts.push_back(task.start);
    return starts;
  }
  bool at_goal(std::uint32_t robot, Vertex place) const {
    return tasks_[robot].goal.value_or(place) == place;
  }
  /// The cost of the robot's way to its goal from a vertex; infinite if it has none, 0 without a goal.
  float cost(std::uint32_t robot, Vertex place) {
    return cost_to_go_[robot] ? cost_to_go_[robot]->from(place) : 0;
  }
  static constexpr float unreachable = std::numeric_limits<float>::infinity();

 private:
  const AnnotatedRoadmap& graph_;
  std::vector<VertexTask> tasks_;
  std::vector<Vertex> numbers_ = numbers_by_neighbourhood(graph_);
  std::vector<std::optional<CostToGo>> cost_to_go_{};  ///< by robot; none if it has no goal
  std::vector<std::uint32_t> shut_in_{};
};

}  // namespace coppice
