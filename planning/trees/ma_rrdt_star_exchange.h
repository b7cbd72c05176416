// The bodies of ma_rrdt_star.h that exchange trees with other processes: inactive trees that come from
// elsewhere, links between inactive trees, and what is published or shown.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "planning/trees/ma_rrdt_star.h"

namespace coppice {

template <Space S>
NodeId MaRrdtStar<S>::add_inactive_trees(const FrozenTrees<D>& frozen) {
  const auto first = static_cast<NodeId>(trees_.node_count());
  TreeIndex t = 0;
  for (std::size_t i = 0; i < frozen.nodes.size(); ++i) {
    const std::int32_t parent = frozen.parents[i];
    if (parent < 0) t = trees_.add_tree(TreeKind::inactive, frozen.radius);
    const NodeId q = trees_.add_node(t, frozen.nodes[i]);
    if (parent >= 0) trees_.add_edge(first + static_cast<NodeId>(parent), q);
  }
  for (NodeId q = first; q < trees_.node_count(); ++q) {
    if (is_near_root_trees(trees_.position(q))) graft_to_root_trees(q);
  }
  return first;
}

/// Grafts the inactive tree of q to the root trees that q sees.
template <Space S>
void MaRrdtStar<S>::graft_to_root_trees(NodeId q) {
  const TreeIndex t = trees_.tree_of(q);
  look_around(trees_.position(q));
  for (const NodeId n : near_) {
    const Tree& root = trees_.tree(trees_.tree_of(n));
    if (root.kind != TreeKind::root || !is_open(root.group) || root.radius > trees_.tree(t).radius) continue;
    if (has_grafted(root.group, root.side, t) || !visible(q, n, root.radius)) continue;
    trees_.add_edge(q, n);
    graft(root.group, root.side, {t, n, q});
  }
}

/// Whether a root tree of an open group may see p.
template <Space S>
bool MaRrdtStar<S>::is_near_root_trees(const P& p) const {
  const auto near = [&](const std::optional<Box<D>>& reach) {
    return reach && distance(*reach, Box<D>{p, p}) <= parameters_.epsilon;
  };
  return std::ranges::any_of(open_,
                             [&](GroupIndex g) { return std::ranges::any_of(groups_[g].reach, near); });
}

template <Space S>
void MaRrdtStar<S>::add_link(NodeId a, NodeId b) {
  const TreeIndex t = trees_.tree_of(a);
  const TreeIndex u = trees_.tree_of(b);
  const double radius = std::min(trees_.tree(t).radius, trees_.tree(u).radius);
  if (t == u || connected(t, u)) return;
  // The segment was tested from one of its ends. From the other end, the result may differ by rounding.
  if (visible(a, b, radius) || visible(b, a, radius)) link(a, b);
}

template <Space S>
void MaRrdtStar<S>::look_for_links(NodeId first) {
  for (NodeId q = first; q < trees_.node_count(); ++q) {
    link_to_seen_trees(q);
    const double radius = trees_.tree(trees_.tree_of(q)).radius;
    for (const NodeId n : near_) {
      const TreeIndex u = trees_.tree_of(n);
      const Tree& other = trees_.tree(u);
      if (other.kind == TreeKind::active && visible(q, n, std::min(radius, other.radius))) freeze(u);
    }
  }
}

/// Links the inactive tree of q to the inactive trees that q sees.
template <Space S>
void MaRrdtStar<S>::link_to_seen_trees(NodeId q) {
  const TreeIndex t = trees_.tree_of(q);
  const double radius = trees_.tree(t).radius;
  look_around(trees_.position(q));
  forest_.layer(radius);  // so that `connected` knows of robots that have no mission yet
  for (const NodeId n : near_) {
    const TreeIndex u = trees_.tree_of(n);
    const Tree& other = trees_.tree(u);
    if (u == t || other.kind != TreeKind::inactive || connected(t, u)) continue;
    if (visible(q, n, std::min(radius, other.radius))) link(q, n);
  }
}

template <Space S>
std::vector<TreeIndex> MaRrdtStar<S>::take_frozen() {
  for (const TreeIndex t : frozen_) trees_.for_each_node(t, [&](NodeId q) { link_to_seen_trees(q); });
  return std::exchange(frozen_, {});
}

template <Space S>
std::size_t MaRrdtStar<S>::active_trees() const {
  std::size_t count = 0;
  for (TreeIndex t = 0; t < trees_.tree_count(); ++t) {
    count += trees_.is_tree(t) && trees_.tree(t).kind == TreeKind::active && trees_.tree(t).size > 0;
  }
  return count;
}

template <Space S>
template <class Fn>
void MaRrdtStar<S>::for_each_active_edge(Fn&& fn) const {
  for (TreeIndex t = 0; t < trees_.tree_count(); ++t) {
    if (!trees_.is_tree(t) || trees_.tree(t).kind != TreeKind::active) continue;
    trees_.for_each_node(t, [&](NodeId n) {
      if (trees_.tree(t).size == 1) fn(trees_.position(n), trees_.position(n));
      trees_.for_each_edge(n, [&](const auto& edge) {
        if (edge.to < n) fn(trees_.position(edge.to), trees_.position(n));
      });
    });
  }
}

}  // namespace coppice
