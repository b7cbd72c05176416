// Converts inactive trees from messages to the form that a planner takes.
#pragma once

#include "messages/messages.h"
#include "planning/frozen_tree.h"

namespace coppice {

inline FrozenTree<2> frozen_tree_of(const InactiveTreeMessage& message) {
  FrozenTree<2> tree{.radius = message.radius, .nodes = {}, .parents = {}};
  for (const InactiveTreeMessage::Node& node : message.nodes) {
    tree.nodes.push_back(node.position);
    tree.parents.push_back(node.parent);
  }
  return tree;
}

}  // namespace coppice
