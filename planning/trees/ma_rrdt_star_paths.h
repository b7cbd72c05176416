// The paths of ma_rrdt_star.h: along the two root trees, and through the forest between them.
#pragma once

#include <limits>
#include <optional>
#include <tuple>
#include <vector>

#include "planning/trees/ma_rrdt_star.h"

namespace coppice {

/// The entries of the two root trees into the component through which they met. If there are several pairs,
/// the one with the shortest estimated path.
template <Space S>
auto MaRrdtStar<S>::meeting(GroupIndex g) const -> std::optional<std::pair<Entry, Entry>> {
  const Group& group = groups_[g];
  std::optional<std::pair<Entry, Entry>> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Entry& a : group.entries[index(Root::start)]) {
    for (const Entry& b : group.entries[index(Root::goal)]) {
      if (forest_.component(group.layer, a.tree) != forest_.component(group.layer, b.tree)) continue;
      const double length = trees_.cost(a.root_tree_node) + trees_.cost(b.root_tree_node) +
                            (trees_.position(a.forest_node) - trees_.position(b.forest_node)).norm();
      if (length >= least) continue;
      least = length;
      best = {a, b};
    }
  }
  return best;
}

/// From a node of a root tree back to its root.
template <Space S>
auto MaRrdtStar<S>::branch(NodeId n) const -> std::vector<P> {
  std::vector<P> points;
  for (; n != no_node; n = trees_.parent(n)) points.push_back(trees_.position(n));
  return points;
}

template <Space S>
auto MaRrdtStar<S>::joined(const Entry& first, std::span<const NodeId> between, const Entry& last) const
    -> std::vector<P> {
  std::vector<P> points = branch(first.root_tree_node);
  std::ranges::reverse(points);
  for (const NodeId n : between) points.push_back(trees_.position(n));
  const std::vector<P> end = branch(last.root_tree_node);
  points.insert(points.end(), end.begin(), end.end());
  return points;
}

template <Space S>
auto MaRrdtStar<S>::path(GroupIndex g) -> std::vector<P> {
  if (!solved(g)) return {};
  const Group& group = groups_[g];
  if (group.met[0] != no_node) return joined({0, group.met[0], no_node}, {}, {0, group.met[1], no_node});
  const auto [first, last] = *meeting(g);
  const auto between =
      shortest_path(trees_, first.forest_node, last.forest_node, usable(group.radius), search_);
  return joined(first, between, last);
}

/// Makes ways_search_ hold a tree of shortest paths that contains both nodes: the known one if it fits, or
/// else a new one.
template <Space S>
void MaRrdtStar<S>::know_ways(const Ways& ways, NodeId from, NodeId to, double radius) {
  if (ways == ways_ && ways_search_.holds(from) && ways_search_.holds(to)) return;
  ways_ = ways;
  grow_shortest_path_tree(trees_, from, usable(radius), ways_search_);
}

template <Space S>
auto MaRrdtStar<S>::paths(std::size_t first_group) -> std::vector<std::vector<P>> {
  std::vector<std::vector<P>> all(groups_.size() - first_group);
  // Groups that share a tree of shortest paths come one after the other.
  std::vector<std::tuple<Forest::Layer, TreeIndex, GroupIndex>> by_ways;
  for (auto g = static_cast<GroupIndex>(first_group); g < groups_.size(); ++g) {
    if (!solved(g)) continue;
    if (groups_[g].met[0] != no_node) {
      all[g - first_group] = path(g);
    } else {
      const Forest::Layer layer = groups_[g].layer;
      by_ways.emplace_back(layer, forest_.component(layer, meeting(g)->first.tree), g);
    }
  }
  std::ranges::sort(by_ways);
  for (const auto& [layer, component, g] : by_ways) {
    const auto [first, last] = *meeting(g);
    know_ways({layer, component, disjointed_counts_.valid, frozen_trees_}, first.forest_node,
              last.forest_node, groups_[g].radius);
    all[g - first_group] =
        joined(first, path_in_tree(ways_search_, first.forest_node, last.forest_node), last);
  }
  return all;
}

}  // namespace coppice
