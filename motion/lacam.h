// How a crowd gets from places to places: LaCAM (Okumura, "LaCAM: Search-Based Algorithm for Quick
// Multi-Agent Pathfinding", 2023) with PIBT (Okumura, Machida, Defago, Tamura, "Priority Inheritance with
// Backtracking for Iterative Multi-agent Path Finding", 2022) as the generator of configurations.
//
// A configuration says who stands at which place. From it PIBT makes the next: in the order of their
// priorities, which grow with the time that a robot is not at its goal, each robot takes the edge that brings
// it nearest to its goal, and whoever stands in its way has to move first. LaCAM searches through the
// configurations, deepest first; one that comes up again is made anew under constraints on who goes where, in
// the end under all. So it finds a solution on the graph if there is one, if it is given the time.
//
// Unlike in the papers, robots are discs and places lie close to each other: an edge has several places near
// it, and all who stand there have to move first. The moves of a step are made one after the other, so there
// are no conflicts between edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "motion/annotated_roadmap.h"
#include "motion/cost_to_go.h"
#include "motion/vertex_task.h"
#include "planning/random.h"

namespace coppice {

class Lacam {
 public:
  /// `graph` outlives it. At most 65,535 robots, of which no two start at one place, and edges of a place.
  /// Robots that could not even alone get to their goals, shut_in(), give way as if they had none.
  Lacam(const AnnotatedRoadmap& graph, std::vector<VertexTask> tasks, Random random);
  const std::vector<std::uint32_t>& shut_in() const { return shut_in_; }

  /// `too_large`: there is no room to remember more configurations; it ends.
  enum class Outcome { searching, solved, no_solution, too_large };
  /// Makes at most so many configurations more.
  Outcome search(std::size_t configurations);

  /// Robots that are not at their goals in the configuration that it has come to; ascending.
  std::vector<std::uint32_t> under_way() const;

  /// Robots that are not at their goals in the best configuration so far, which has the fewest of them;
  /// ascending. None once solved.
  std::vector<std::uint32_t> left_over() const { return under_way_in(nodes_[best_].at); }

  /// To the best configuration: one after the other, all others standing.
  std::vector<VertexMove> moves() const;

 private:
  using Configuration = std::vector<Vertex>;  // by robot
  struct Forced {
    std::uint32_t robot;
    Vertex to;
  };
  /// A set of constraints: one more than in another set. The first of a node is the empty one.
  struct Constraint {
    std::uint32_t others = 0;
    Forced last{};
  };
  /// Of a robot that moves, at most once, from where the parent has it.
  struct Step {
    std::uint16_t robot;
    std::uint16_t edge;
  };
  struct Node {
    Configuration at;
    std::uint32_t parent;
    std::vector<Step> steps;              ///< from the parent's configuration
    std::vector<std::uint16_t> waits;     ///< of the robots: configurations since they were at their goals
    std::vector<Constraint> constraints;  ///< each the last of a set: those tried, and those still to be
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
  std::vector<Vertex> numbers_;  ///< of the places
  std::vector<std::optional<CostToGo>> cost_to_go_;  ///< by robot, if it has a goal
  std::deque<Node> nodes_;
  std::vector<std::size_t> open_;
  std::unordered_multimap<std::uint64_t, std::size_t> known_;  ///< by the configuration's hash
  std::size_t best_ = 0;
  std::size_t least_under_way_ = 0;  ///< in the best

  std::vector<std::uint32_t> order_;  ///< of the robots of the node at hand, highest priority first

  // The configuration that is being made.
  static constexpr std::uint32_t nobody = ~std::uint32_t{0};
  Configuration at_;
  std::vector<std::uint32_t> occupant_;        ///< by place
  std::vector<bool> decided_;                  ///< by robot
  std::vector<std::optional<Vertex>> forced_;  ///< by robot
  std::vector<Reserved> reserved_;             ///< edges of those who wait for others to make room
  std::vector<Step> steps_;
};

}  // namespace coppice
