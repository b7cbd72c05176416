// The choice of parent and the rewiring of RRT* (Karaman, Frazzoli, "Sampling-based Algorithms for Optimal
// Motion Planning", 2011, Algorithm 6), for a node that has just joined its tree.
//
// Metres.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "planning/trees/trees.h"

namespace coppice {

/// Updates the costs of all nodes below n after n has become cheaper.
template <int D>
void propagate_cost(Trees<D>& trees, NodeId n) {
  std::vector<NodeId> changed{n};
  while (!changed.empty()) {
    const NodeId parent = changed.back();
    changed.pop_back();
    trees.for_each_edge(parent, [&](const auto& edge) {
      if (trees.parent(edge.to) != parent) return;
      const double length = (trees.position(edge.to) - trees.position(parent)).norm();
      trees.set_parent(edge.to, parent, trees.cost(parent) + length);
      changed.push_back(edge.to);
    });
  }
}

/// Chooses the cheapest parent for q among the visible nodes of its tree (`seen`, at least one), then rewires
/// the nodes for which the way through q is shorter. All edges stay, for the search for paths.
template <int D>
void choose_parent_and_rewire(Trees<D>& trees, NodeId q, std::span<const NodeId> seen) {
  const auto distance = [&](NodeId n) { return (trees.position(n) - trees.position(q)).norm(); };
  const NodeId parent =
      *std::ranges::min_element(seen, std::less{}, [&](NodeId n) { return trees.cost(n) + distance(n); });
  trees.set_parent(q, parent, trees.cost(parent) + distance(parent));
  for (const NodeId n : seen) {
    trees.add_edge(q, n);
    const double through = trees.cost(q) + distance(n);
    if (n == parent || through >= trees.cost(n)) continue;
    trees.set_parent(n, q, through);
    propagate_cost(trees, n);
  }
}

}  // namespace coppice
