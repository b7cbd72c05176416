// Weighted A* (Hart, Nilsson, Raphael, 1968; Pohl, 1970) over the joint configurations of a few robots: each
// step moves one robot along one edge, all others standing. It finds a solution on the graph if there is one,
// and proves that there is none if it may remember all configurations. For few robots in narrow passages,
// where LaCAM (lacam.h) goes astray, all configurations are few.
//
// Costs are metres, summed over the robots. The heuristic is the sum of the ways that the robots have left
// when they are alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "motion/annotated_roadmap.h"
#include "motion/cost_to_go.h"
#include "motion/vertex_task.h"

namespace coppice {

class JointAStar {
 public:
  /// Whether a configuration of so many robots on so many places fits into a key.
  static bool fits(std::size_t places, std::size_t robots);

  /// `graph` outlives it; it fits. Every goal can be reached from its start when its robot is alone.
  JointAStar(const AnnotatedRoadmap& graph, std::vector<VertexTask> tasks);

  /// `too_large`: it may remember no more configurations.
  enum class Outcome { searching, solved, no_solution, too_large };
  /// Looks at about so many moves more.
  Outcome search(std::size_t moves);

  /// One robot after the other, all others standing. Only once solved.
  std::vector<VertexMove> moves() const;

 private:
  using Key = std::uint64_t;  ///< the places of the robots, `bits_` each, the first robot lowest
  struct Node {
    float cost;
    std::uint16_t robot = 0;  ///< that moved here from the parent
    std::uint16_t edge = 0;   ///< that it took
    Key parent = 0;
  };
  struct Entry {
    float estimate;
    float cost;
    Key at;
  };

  Vertex place(Key at, std::size_t robot) const {
    return static_cast<Vertex>(at >> (robot * bits_) & ((Key{1} << bits_) - 1));
  }
  Key moved(Key at, std::size_t robot, Vertex to) const;
  bool is_goal(Key at) const;
  bool is_clear(Key at, std::size_t robot, const AnnotatedRoadmap::Edge& edge) const;
  float to_go(Key at);
  void reach(Key at, const Node& node);
  std::size_t expand(Key at);

  const AnnotatedRoadmap& graph_;
  std::vector<VertexTask> tasks_;
  std::size_t bits_;
  std::vector<Vertex> numbers_;
  std::vector<std::optional<CostToGo>> cost_to_go_;  ///< by robot, if it has a goal
  std::unordered_map<Key, Node> nodes_;
  std::vector<Entry> open_;  ///< a heap
  Key start_ = 0;
  std::optional<Key> end_;
};

}  // namespace coppice
