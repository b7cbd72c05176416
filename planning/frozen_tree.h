// An inactive tree by itself, as the broker sends it to the agents that graft it.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "planning/trees.h"

namespace coppice {

template <int D>
struct FrozenTree {
  double radius = 0;                  ///< metres; each node and edge keeps at least this clearance
  std::vector<Point<D>> nodes;        ///< node 0 is the root
  std::vector<std::int32_t> parents;  ///< index of each node's parent, below its own index; -1 for the root
};

/// Copies tree `t` breadth first from its first node, so that parents come before their children.
template <int D>
FrozenTree<D> freeze_copy(const Trees<D>& trees, TreeIndex t) {
  FrozenTree<D> copy{.radius = trees.tree(t).radius, .nodes = {}, .parents = {}};
  std::vector<NodeId> order{trees.tree(t).first};
  std::unordered_map<NodeId, std::int32_t> place{{order.front(), 0}};
  copy.parents.push_back(-1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    copy.nodes.push_back(trees.position(order[i]));
    trees.for_each_edge(order[i], [&](const auto& edge) {
      if (trees.tree_of(edge.to) != t) return;
      if (!place.emplace(edge.to, static_cast<std::int32_t>(order.size())).second) return;
      order.push_back(edge.to);
      copy.parents.push_back(static_cast<std::int32_t>(i));
    });
  }
  return copy;
}

}  // namespace coppice
