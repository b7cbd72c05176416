// Converts inactive trees from messages to the form that a planner takes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "messages/messages.h"
#include "planning/frozen_tree.h"

namespace coppice {

/// The number of trees: each begins with a node without a parent.
inline std::uint32_t number_of_trees(const InactiveTreesMessage& message) {
  return static_cast<std::uint32_t>(
      std::ranges::count(message.nodes, -1, &InactiveTreesMessage::Node::parent));
}

inline std::vector<FrozenTree<2>> frozen_trees_of(const InactiveTreesMessage& message) {
  std::vector<FrozenTree<2>> trees;
  std::int32_t first = 0;  // node of the tree
  for (std::int32_t k = 0; std::cmp_less(k, message.nodes.size()); ++k) {
    const InactiveTreesMessage::Node& node = message.nodes[static_cast<std::size_t>(k)];
    if (node.parent < 0) {
      trees.push_back({.radius = message.radius, .nodes = {}, .parents = {}});
      first = k;
    }
    trees.back().nodes.push_back(node.position);
    trees.back().parents.push_back(node.parent < 0 ? -1 : node.parent - first);
  }
  return trees;
}

}  // namespace coppice
