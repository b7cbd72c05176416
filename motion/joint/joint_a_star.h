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

#include "motion/joint/cluster.h"

namespace coppice {

class JointAStar {
 public:
  /// `cluster` must outlive it.
  explicit JointAStar(Cluster& cluster);

  /// Does a bounded amount of work. Gives up if there is no solution, if the configurations do not fit into
  /// keys, or if it would store too many of them.
  SearchState step();

  /// The moves of the solution. Valid only once solved.
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

  Cluster& cluster_;
  std::size_t bits_;
  std::unordered_map<Key, Node> nodes_{};
  std::vector<Entry> open_{};  ///< a heap
  Key start_ = 0;
  std::optional<Key> end_{};
};

}  // namespace coppice
