// Inactive trees by themselves, as the broker sends them to the agents that graft them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "planning/trees/trees.h"

namespace coppice {

template <int D>
struct FrozenTrees {
  double radius = 0;                  ///< metres; each node and edge keeps at least this clearance
  std::vector<Point<D>> nodes;        ///< the nodes of a tree follow each other
  std::vector<std::int32_t> parents;  ///< index of each node's parent, below its own index; -1: a root
};

/// The nodes of tree `t` breadth first from its first node: each but the first has an edge to an earlier one.
template <int D>
std::vector<NodeId> breadth_first(const Trees<D>& trees, TreeIndex t) {
  std::vector<NodeId> order{trees.tree(t).first};
  std::unordered_set<NodeId> found{order.front()};
  for (std::size_t i = 0; i < order.size(); ++i) {
    trees.for_each_edge(order[i], [&](const auto& edge) {
      if (trees.tree_of(edge.to) == t && found.insert(edge.to).second) order.push_back(edge.to);
    });
  }
  return order;
}

}  // namespace coppice
