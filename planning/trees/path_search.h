// Paths through the forest of inactive trees.
//
// Grafting by reference keeps no cost-to-come for the nodes of a grafted tree. The searches here compute
// them: A* (Hart, Nilsson, Raphael, 1968) with the straight-line distance for one path, or one tree of
// shortest paths (Dijkstra, 1959) for many.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "planning/trees/trees.h"

namespace coppice {

/// Memory that searches share, so that each search touches only what it visits.
struct SearchScratch {
  struct Label {
    std::uint32_t search = 0;  ///< number of the search that wrote this label
    NodeId parent = no_node;
    double cost = 0;
    std::uint32_t depth = 0;  ///< in a tree of shortest paths
    bool closed = false;
  };
  std::vector<Label> labels;
  std::uint32_t search = 0;

  /// Whether the last search reached this node.
  bool holds(NodeId n) const { return n < labels.size() && search > 0 && labels[n].search == search; }
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
      l = {scratch.search, no_node, std::numeric_limits<double>::infinity(), 0, false};
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

/// Stores in the scratch the tree of shortest paths from `from` to all nodes that usable trees lead to.
template <int D, class Usable>
void grow_shortest_path_tree(const Trees<D>& trees, NodeId from, Usable&& usable, SearchScratch& scratch) {
  using Entry = std::pair<double, NodeId>;
  scratch.labels.resize(trees.node_count());
  ++scratch.search;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  scratch.labels[from] = {scratch.search, no_node, 0, 0, false};
  open.emplace(0, from);
  while (!open.empty()) {
    const double cost = open.top().first;
    const NodeId n = open.top().second;
    open.pop();
    if (std::exchange(scratch.labels[n].closed, true)) continue;
    const std::uint32_t depth = scratch.labels[n].depth + 1;
    trees.for_each_edge(n, [&](const auto& edge) {
      if (!usable(trees.tree(trees.tree_of(edge.to)))) return;
      auto& there = scratch.labels[edge.to];
      const double through = cost + static_cast<double>(edge.length);
      if (there.search == scratch.search && (there.closed || through >= there.cost)) return;
      there = {scratch.search, n, through, depth, false};
      open.emplace(through, edge.to);
    });
  }
}

/// The way between two nodes of the tree that grow_shortest_path_tree stored in the scratch.
inline std::vector<NodeId> path_in_tree(const SearchScratch& scratch, NodeId from, NodeId to) {
  const auto& labels = scratch.labels;
  std::vector<NodeId> up{from};
  std::vector<NodeId> down{to};
  while (up.back() != down.back()) {
    auto& deeper = labels[up.back()].depth >= labels[down.back()].depth ? up : down;
    deeper.push_back(labels[deeper.back()].parent);
  }
  down.pop_back();
  up.insert(up.end(), down.rbegin(), down.rend());
  return up;
}

}  // namespace coppice
