// The nodes and edges of all trees: active disjointed trees, inactive ones, and the groups' root trees.
//
// A tree is a set of nodes. Merging two trees is a union of sets (union-find, small to large) and moves
// nothing. Edges are undirected, and free for a ball of the smaller of the two trees' radii. The edges of a
// disjointed tree connect all of its nodes; some may close a cycle, which only gives shorter paths. A root
// tree also stores each node's parent and cost-to-come, as RRT* needs them.
//
// Metres.
#pragma once

#include <cassert>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "coppice/planning/geometry.h"
#include "planning/geometry/neighbour_grid.h"
#include "planning/trees/root.h"

namespace coppice {

using TreeIndex = std::uint32_t;
using GroupIndex = std::uint32_t;

enum class TreeKind : std::uint8_t {
  active,    ///< disjointed, still grows
  inactive,  ///< disjointed, met a root tree; it never changes again, and every group may graft it
  root,      ///< rooted at a group's start or goal
};

struct Tree {
  TreeKind kind = TreeKind::active;
  Root side = Root::start;  ///< of a root tree
  GroupIndex group = 0;     ///< of a root tree
  double radius = 0;        ///< metres; each node and edge keeps at least this clearance
  NodeId first = no_node;   ///< first of the list of its nodes
  NodeId last = no_node;
  std::uint32_t size = 0;
};

template <int D>
class Trees {
 public:
  struct Edge {
    NodeId to;
    std::uint32_t next;  ///< next edge of the same node, or no_edge
    float length;
  };
  static constexpr std::uint32_t no_edge = std::numeric_limits<std::uint32_t>::max();

  Trees(const Box<D>& bounds, double reach) : grid_(bounds, reach) {}

  TreeIndex add_tree(TreeKind kind, double radius, GroupIndex group = 0, Root side = Root::start) {
    const auto index = static_cast<TreeIndex>(trees_.size());
    trees_.push_back({.kind = kind, .side = side, .group = group, .radius = radius});
    union_.push_back(index);
    return index;
  }

  NodeId add_node(TreeIndex tree, const Point<D>& p) {
    const auto n = static_cast<NodeId>(position_.size());
    position_.push_back(p);
    member_of_.push_back(tree);
    first_edge_.push_back(no_edge);
    next_in_tree_.push_back(no_node);
    parent_.push_back(no_node);
    cost_.push_back(0);
    grid_.insert(p);
    Tree& t = trees_[tree];
    (t.first == no_node ? t.first : next_in_tree_[t.last]) = n;
    t.last = n;
    ++t.size;
    return n;
  }

  void add_edge(NodeId a, NodeId b) {
    const auto length = static_cast<float>((position_[a] - position_[b]).norm());
    add_half_edge(a, b, length);
    add_half_edge(b, a, length);
  }

  /// Merges two active trees of the same radius. Returns the index of the result.
  TreeIndex merge(TreeIndex a, TreeIndex b) {
    assert(a != b && trees_[a].kind == TreeKind::active && trees_[b].kind == TreeKind::active);
    if (trees_[a].size < trees_[b].size) std::swap(a, b);
    union_[b] = a;
    next_in_tree_[trees_[a].last] = trees_[b].first;
    trees_[a].last = trees_[b].last;
    trees_[a].size += trees_[b].size;
    return a;
  }

  TreeIndex tree_of(NodeId n) const {
    TreeIndex t = member_of_[n];
    while (union_[t] != t) t = union_[t] = union_[union_[t]];
    return member_of_[n] = t;
  }

  Tree& tree(TreeIndex t) { return trees_[t]; }
  const Tree& tree(TreeIndex t) const { return trees_[t]; }
  /// Whether `t` names a tree that has not been merged into another.
  bool is_tree(TreeIndex t) const { return union_[t] == t; }
  std::size_t tree_count() const { return trees_.size(); }

  std::size_t node_count() const { return position_.size(); }
  const Point<D>& position(NodeId n) const { return position_[n]; }
  NodeId parent(NodeId n) const { return parent_[n]; }
  double cost(NodeId n) const { return cost_[n]; }
  void set_parent(NodeId n, NodeId parent, double cost) {
    parent_[n] = parent;
    cost_[n] = cost;
  }

  template <class Fn>
  void for_each_edge(NodeId n, Fn&& fn) const {
    for (std::uint32_t e = first_edge_[n]; e != no_edge; e = edges_[e].next) fn(edges_[e]);
  }
  template <class Fn>
  void for_each_node(TreeIndex t, Fn&& fn) const {
    for (NodeId n = trees_[t].first; n != no_node; n = next_in_tree_[n]) fn(n);
  }

  const NeighbourGrid<D>& grid() const { return grid_; }

 private:
  void add_half_edge(NodeId from, NodeId to, float length) {
    edges_.push_back({to, first_edge_[from], length});
    first_edge_[from] = static_cast<std::uint32_t>(edges_.size() - 1);
  }

  NeighbourGrid<D> grid_;
  std::vector<Tree> trees_;
  mutable std::vector<TreeIndex> union_;  // path halving: a look-up shortens the chain for the next one
  std::vector<Point<D>> position_;
  mutable std::vector<TreeIndex> member_of_;  // updated by look-ups, too
  std::vector<std::uint32_t> first_edge_;
  std::vector<NodeId> next_in_tree_;
  std::vector<NodeId> parent_;
  std::vector<double> cost_;
  std::vector<Edge> edges_;
};

}  // namespace coppice
