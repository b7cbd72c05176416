// Weighted A* (Hart, Nilsson, Raphael, 1968; Pohl, 1970) over the joint configurations of a few robots: each
// step moves one robot along one edge while all others stand. If the graph has a solution, the search finds
// it. If it has none, the search proves it, provided that it may store all configurations. It serves few
// robots in narrow passages, where LaCAM (lacam.h) goes astray and the configurations are few.
//
// Costs are metres, summed over the robots. The heuristic is the sum of the ways that the robots would still
// have to drive if each were alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "motion/joint/vertex_task.h"
#include "motion/lattice/annotated_roadmap.h"
#include "motion/lattice/cost_to_go.h"

namespace coppice {

class JointAStar {
 public:
  /// Whether a configuration of so many robots on so many vertices fits into a key.
  static bool fits(std::size_t places, std::size_t robots);

  /// `graph` must outlive it, and fits() must hold. Each goal must be reachable from its start if its robot
  /// is alone.
  JointAStar(const AnnotatedRoadmap& graph, std::vector<VertexTask> tasks);

  /// `too_large`: the limit of stored configurations is reached.
  enum class Outcome { searching, solved, no_solution, too_large };
  /// Examines about `moves` further moves.
  Outcome search(std::size_t moves);

  /// The moves of the solution, one robot after the other while all others stand. Valid only once solved.
  std::vector<VertexMove> moves() const;

 private:
  using Key = std::uint64_t;  ///< the robots' vertices, `bits_` each, the first robot in the lowest bits
  struct Node {
    float cost;
    std::uint16_t robot = 0;  ///< the robot that moved here from the parent
    std::uint16_t edge = 0;   ///< the edge that it took
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
  std::vector<std::optional<CostToGo>> cost_to_go_;  ///< by robot; none if it has no goal
  std::unordered_map<Key, Node> nodes_;
  std::vector<Entry> open_;  ///< a heap
  Key start_ = 0;
  std::optional<Key> end_;
};

}  // namespace coppice
