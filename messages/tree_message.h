// Converts inactive trees from messages to the form that a planner takes.
#pragma once

#include <algorithm>
#include <cstdint>

#include "messages/messages.h"
#include "planning/trees/frozen_trees.h"

namespace coppice {

/// The number of trees: each begins with a node without a parent.
inline std::uint32_t number_of_trees(const InactiveTreesMessage& message) {
  return static_cast<std::uint32_t>(
      std::ranges::count(message.nodes, -1, &InactiveTreesMessage::Node::parent));
}

inline FrozenTrees<2> frozen_trees_of(const InactiveTreesMessage& message) {
  FrozenTrees<2> trees{.radius = message.radius, .nodes = {}, .parents = {}};
  trees.nodes.reserve(message.nodes.size());
  trees.parents.reserve(message.nodes.size());
  for (const InactiveTreesMessage::Node& node : message.nodes) {
    trees.nodes.push_back(node.position);
    trees.parents.push_back(node.parent);
  }
  return trees;
}

}  // namespace coppice
