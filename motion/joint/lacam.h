// Moves a cluster of robots between configurations: LaCAM (Okumura, "LaCAM: Search-Based Algorithm for Quick
// Multi-Agent Pathfinding", 2023) with PIBT (pibt.h) as the generator of configurations.
//
// LaCAM searches the configurations depth first. A robot's priority grows with the time that it is away from
// its goal. If a configuration comes up again, it is expanded under constraints on which robot goes where, in
// the end under all constraints. So LaCAM finds a solution on the graph if there is one and the time
// suffices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "coppice/planning/random.h"
#include "motion/joint/cluster.h"
#include "motion/joint/pibt.h"

namespace coppice {

class Lacam {
 public:
  /// `cluster` must outlive it.
  Lacam(Cluster& cluster, Random random);

  /// Makes at most `configurations` further configurations. Gives up if there are no more, or if it would
  /// store too many of them.
  SearchState search(std::size_t configurations);
  SearchState step() { return search(1000); }

  /// Robots that are not at their goals in the configuration that the search has reached; ascending.
  std::vector<std::uint32_t> under_way() const;

  /// The moves to the best configuration so far, in which the fewest robots are not at their goals.
  std::vector<VertexMove> moves() const;

 private:
  /// A set of constraints is another set and one constraint more. The first set of a node is empty.
  struct Constraint {
    std::uint32_t others = 0;
    Pibt::Forced last{};
  };
  struct Node {
    Configuration at;
    std::uint32_t parent;
    std::vector<Pibt::Step> steps;     ///< from the parent's configuration
    std::vector<std::uint16_t> waits;  ///< by robot: configurations since it was at its goal
    /// Each is the last constraint of a set: the sets tried, then those still to be tried.
    std::vector<Constraint> constraints;
    std::uint32_t tried = 0;
  };

  std::vector<std::uint32_t> under_way_in(const Configuration& at) const;
  std::size_t add(const Configuration& at, const std::vector<Pibt::Step>& steps, std::size_t parent);
  std::optional<std::size_t> known(const Configuration& at) const;
  std::vector<Pibt::Forced> next_constraints(Node& node);
  void set_order(const Node& node);

  Cluster& cluster_;
  Random random_;
  Pibt pibt_;
  std::vector<float> least_{};  ///< by robot, below 1: its priority while it does not wait
  std::deque<Node> nodes_{};
  std::vector<std::size_t> open_{};
  std::unordered_multimap<std::uint64_t, std::size_t> known_{};  ///< by the configuration's hash
  std::size_t best_ = 0;
  std::size_t least_under_way_ = 0;     ///< in the best configuration
  std::vector<std::uint32_t> order_{};  ///< robots of the current node, highest priority first
};

}  // namespace coppice
