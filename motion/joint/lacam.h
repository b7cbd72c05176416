// Moves a cluster of robots between configurations: LaCAM (Okumura, "LaCAM: Search-Based Algorithm for Quick
// Multi-Agent Pathfinding", 2023) with PIBT (Okumura, Machida, Defago, Tamura, "Priority Inheritance with
// Backtracking for Iterative Multi-agent Path Finding", 2022) as the generator of configurations.
//
// A configuration holds one roadmap vertex for each robot. PIBT makes the next configuration from it: in the
// order of their priorities, which grow with the time that a robot is away from its goal, each robot takes
// the edge that brings it nearest to its goal, and the robots in its way have to move first. LaCAM searches
// the configurations depth first. If a configuration comes up again, it is expanded under constraints on
// which robot goes where, in the end under all constraints. So LaCAM finds a solution on the graph if there
// is one and the time suffices.
//
// Unlike in the papers, robots are discs and vertices lie close to each other: an edge has several vertices
// near it, and all robots that stand there have to move first. The moves of a step are made one after the
// other, so there are no conflicts between edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/joint/vertex_task.h"
#include "motion/lattice/annotated_roadmap.h"
#include "motion/lattice/cost_to_go.h"

namespace coppice {

class Lacam {
 public:
  /// `graph` must outlive it. At most 65,535 robots, and at most 65,535 edges at a vertex; no two robots
  /// start at one vertex. Robots that could not reach their goals even if they were alone, shut_in(), give
  /// way as if they had no goal.
  Lacam(const AnnotatedRoadmap& graph, std::vector<VertexTask> tasks, Random random);
  const std::vector<std::uint32_t>& shut_in() const { return shut_in_; }

  /// `too_large`: the limit of stored configurations is reached; the search ends.
  enum class Outcome { searching, solved, no_solution, too_large };
  /// Makes at most `configurations` further configurations.
  Outcome search(std::size_t configurations);

  /// Robots that are not at their goals in the configuration that the search has reached; ascending.
  std::vector<std::uint32_t> under_way() const;

  /// Robots that are not at their goals in the best configuration so far, which has the fewest of them;
  /// ascending. Empty once solved.
  std::vector<std::uint32_t> left_over() const { return under_way_in(nodes_[best_].at); }

  /// The moves to the best configuration, one robot after the other while all others stand.
  std::vector<VertexMove> moves() const;

 private:
  using Configuration = std::vector<Vertex>;  // by robot
  struct Forced {
    std::uint32_t robot;
    Vertex to;
  };
  /// A set of constraints is another set and one constraint more. The first set of a node is empty.
  struct Constraint {
    std::uint32_t others = 0;
    Forced last{};
  };
  /// The step of a robot that moves. A robot moves at most once, from its vertex in the parent.
  struct Step {
    std::uint16_t robot;
    std::uint16_t edge;
  };
  struct Node {
    Configuration at;
    std::uint32_t parent;
    std::vector<Step> steps;           ///< from the parent's configuration
    std::vector<std::uint16_t> waits;  ///< by robot: configurations since it was at its goal
    /// Each is the last constraint of a set: the sets tried, then those still to be tried.
    std::vector<Constraint> constraints;
    std::uint32_t tried = 0;
  };
  struct Candidate {
    float cost;
    const AnnotatedRoadmap::Edge* edge;  ///< null: stay
  };
  struct Reserved {
    Vertex from;
    const AnnotatedRoadmap::Edge* edge;
  };

  float cost(std::uint32_t robot, Vertex place) {
    return cost_to_go_[robot] ? cost_to_go_[robot]->from(place) : 0;
  }
  bool at_goal(std::uint32_t robot, Vertex place) const {
    return !tasks_[robot].goal || *tasks_[robot].goal == place;
  }
  std::vector<std::uint32_t> under_way_in(const Configuration& at) const;
  std::size_t add(const Configuration& at, std::size_t parent);
  std::optional<std::size_t> known(const Configuration& at) const;
  std::vector<Forced> next_constraints(Node& node);
  bool generate(const Node& node, const std::vector<Forced>& forced);
  void set_order(const Node& node);
  std::vector<Candidate> candidates(std::uint32_t robot);
  bool in_nobodys_way(Vertex here, const AnnotatedRoadmap::Edge* edge) const;
  bool empty_around(const AnnotatedRoadmap::Edge& edge, std::uint32_t robot) const;
  bool clear(const AnnotatedRoadmap::Edge& edge, std::uint32_t robot);
  bool push(std::uint32_t robot);

  const AnnotatedRoadmap& graph_;
  std::vector<VertexTask> tasks_;
  std::vector<std::uint32_t> shut_in_;  ///< ascending
  Random random_;
  std::vector<float> least_;     ///< by robot, below 1: its priority while it does not wait
  std::vector<Vertex> numbers_;  ///< numbers of the vertices (numbers_by_neighbourhood)
  std::vector<std::optional<CostToGo>> cost_to_go_;  ///< by robot; none if it has no goal
  std::deque<Node> nodes_;
  std::vector<std::size_t> open_;
  std::unordered_multimap<std::uint64_t, std::size_t> known_;  ///< by the configuration's hash
  std::size_t best_ = 0;
  std::size_t least_under_way_ = 0;  ///< in the best configuration

  std::vector<std::uint32_t> order_;  ///< robots of the current node, highest priority first

  // The configuration that is being generated.
  static constexpr std::uint32_t nobody = ~std::uint32_t{0};
  Configuration at_;
  std::vector<std::uint32_t> occupant_;        ///< by vertex
  std::vector<bool> decided_;                  ///< by robot
  std::vector<std::optional<Vertex>> forced_;  ///< by robot
  std::vector<Reserved> reserved_;             ///< edges of the robots that wait for others to make room
  std::vector<Step> steps_;
};

}  // namespace coppice
