// Makes the next configuration of a cluster: PIBT (Okumura, Machida, Defago, Tamura, "Priority Inheritance
// with Backtracking for Iterative Multi-agent Path Finding", 2022).
//
// A configuration holds one roadmap vertex for each robot. In the order of their priorities, each robot takes
// the edge that brings it nearest to its goal, and the robots in its way have to move first.
//
// Unlike in the paper, robots are discs and vertices lie close to each other: an edge has several vertices
// near it, and all robots that stand there have to move first. The moves of a step are made one after the
// other, so there are no conflicts between edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/joint/cluster.h"

namespace coppice {

class Pibt {
 public:
  /// A robot must be at a vertex in the next configuration.
  struct Forced {
    std::uint32_t robot;
    Vertex to;
  };
  /// A robot moves at most once, from its vertex in the configuration before, along an edge of that vertex.
  struct Step {
    std::uint16_t robot;
    std::uint16_t edge;
  };

  /// `cluster` must outlive it. At most 65,535 robots, and at most 65,535 edges at a vertex.
  explicit Pibt(Cluster& cluster)
      : cluster_(cluster),
        graph_(cluster.graph()),
        occupant_(graph_.size(), nobody),
        decided_(cluster.size()),
        forced_(cluster.size()) {}

  /// Makes the next configuration, and the steps that lead there. Robots are asked in the given order.
  /// Returns false if the forced moves cannot be made.
  bool generate(const Configuration& from, std::span<const std::uint32_t> order,
                std::span<const Forced> forced, Random& random);
  const Configuration& next() const { return at_; }
  const std::vector<Step>& steps() const { return steps_; }

 private:
  static constexpr std::uint32_t nobody = ~std::uint32_t{0};
  struct Candidate {
    float cost;
    const AnnotatedRoadmap::Edge* edge;  ///< null: stay
  };
  struct Reserved {
    Vertex from;
    const AnnotatedRoadmap::Edge* edge;
  };

  bool push(std::uint32_t robot, Random& random);
  std::vector<Candidate> candidates(std::uint32_t robot, Random& random);
  bool in_nobodys_way(Vertex here, const AnnotatedRoadmap::Edge* edge) const;
  bool clear(const AnnotatedRoadmap::Edge& edge, std::uint32_t robot, Random& random);
  bool empty_around(const AnnotatedRoadmap::Edge& edge, std::uint32_t robot) const;

  Cluster& cluster_;
  const AnnotatedRoadmap& graph_;

  // The configuration that is being generated.
  Configuration at_{};
  std::vector<std::uint32_t> occupant_;        ///< by vertex
  std::vector<bool> decided_;                  ///< by robot
  std::vector<std::optional<Vertex>> forced_;  ///< by robot
  std::vector<Reserved> reserved_{};           ///< edges of the robots that wait for others to make room
  std::vector<Step> steps_{};
};

}  // namespace coppice
