// A group's path through its two root trees and the inactive trees that it may graft.
//
// Grafting by reference keeps no cost-to-come for the nodes of a grafted tree; they are computed here, along
// the one search that matters: A* (Hart, Nilsson, Raphael, 1968) with the straight-line distance.
#pragma once

#include <algorithm>
#include <limits>
#include <queue>
#include <vector>

#include "planning/trees.h"

namespace coppice {

/// Memory that searches share, so that each only touches what it visits.
struct SearchScratch {
  struct Label {
    std::uint32_t search = 0;  ///< which search wrote this label
    NodeId parent = no_node;
    double cost = 0;
    bool closed = false;
  };
  std::vector<Label> labels;
  std::uint32_t search = 0;
};

/// The shortest chain of nodes from `from` to `to` over the edges of the trees for which `usable(tree)`
/// holds; empty if there is none.
template <int D, class Usable>
std::vector<NodeId> shortest_path(const Trees<D>& trees, NodeId from, NodeId to, Usable&& usable,
                                  SearchScratch& scratch) {
  using Entry = std::pair<double, NodeId>;
  scratch.labels.resize(trees.node_count());
  ++scratch.search;
  auto label = [&](NodeId n) -> SearchScratch::Label& {
    auto& l = scratch.labels[n];
    if (l.search != scratch.search)
      l = {scratch.search, no_node, std::numeric_limits<double>::infinity(), false};
    return l;
  };
  auto estimate = [&](NodeId n) { return (trees.position(n) - trees.position(to)).norm(); };

  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  label(from).cost = 0;
  open.emplace(estimate(from), from);
  while (!open.empty()) {
    const NodeId n = open.top().second;
    open.pop();
    auto& here = label(n);
    if (here.closed) continue;
    here.closed = true;
    if (n == to) break;
    const double cost = here.cost;
    trees.for_each_edge(n, [&](const auto& edge) {
      if (!usable(trees.tree(trees.tree_of(edge.to)))) return;
      auto& there = label(edge.to);
      const double through = cost + static_cast<double>(edge.length);
      if (there.closed || through >= there.cost) return;
      there.cost = through;
      there.parent = n;
      open.emplace(through + estimate(edge.to), edge.to);
    });
  }

  std::vector<NodeId> chain;
  if (!label(to).closed) return chain;
  for (NodeId n = to; n != no_node; n = label(n).parent) chain.push_back(n);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

}  // namespace coppice
