// The bodies of ma_rrdt_star.h, in the order of Algorithm 2: the loop, the samples, merging, grafting, paths.
#pragma once

#include <limits>
#include <optional>

#include "planning/ma_rrdt_star.h"

namespace coppice {

template <Space S>
bool MaRrdtStar<S>::step() {
  if (open_.empty()) return false;
  for (; disjointed_arms_ < settings_.disjointed_trees; ++disjointed_arms_) arms_.emplace_back();
  if (std::exchange(some_group_left_, false)) {
    std::erase_if(arms_, [&](const Arm& arm) { return arm.group != no_group && !is_open(arm.group); });
  }
  if (arms_.empty()) return false;

  Arm& arm = pick_tree();
  if (!failing(arm)) {
    grow(arm);
  } else if (arm.group == no_group) {
    restart(arm);
  } else {
    restart_root(arm);
  }
  return true;
}

/// At random, in proportion to the weights: a uniform choice that is kept with probability weight / full
/// weight.
template <Space S>
auto MaRrdtStar<S>::pick_tree() -> Arm& {
  while (true) {
    Arm& arm = arms_[random_.index(arms_.size())];
    if (random_.uniform() * full_weight < arm.weight) return arm;
  }
}

template <Space S>
bool MaRrdtStar<S>::failing(const Arm& arm) const {
  if (arm.node == no_node || arm.weight < restart_weight) return true;
  return arm.group == no_group && trees_.tree(trees_.tree_of(arm.node)).kind != TreeKind::active;
}

/// A new disjointed tree at a random free point. Near a disjointed tree it becomes a node of that one; near a
/// root tree, or one that is grafted, it is a shared tree of one node that is grafted at once.
template <Space S>
void MaRrdtStar<S>::restart(Arm& arm) {
  const double radius = groups_[open_[random_.index(open_.size())]].radius;
  const std::optional<P> p = random_free_point(radius);
  if (!p || !worth_a_node(*p, radius)) return;
  ++disjointed_counts_.valid;
  arm = Arm{trees_.add_node(trees_.add_tree(TreeKind::active, radius), *p)};
  compare_disjointed_node(arm.node);
}

/// The more nodes of shared trees a point sees close by, the less it teaches, and the less likely it is to be
/// kept: so the density of nodes stays bounded, yet no point is excluded for ever, which would break
/// completeness.
template <Space S>
bool MaRrdtStar<S>::worth_a_node(const P& p, double radius) {
  const double reach = least_spacing * settings_.epsilon;
  int seen = 0;
  trees_.grid().for_each_near(p, [&](NodeId n) {
    const Tree& tree = trees_.tree(trees_.tree_of(n));
    if (tree.kind == TreeKind::root || tree.radius < radius) return;
    if ((trees_.position(n) - p).norm() < reach && space_.segment_free(trees_.position(n), p, radius)) ++seen;
  });
  return random_.uniform() * (1 + seen) * (1 + seen) < 1;
}

/// A root tree cannot leave its root: it goes on from the one of its nodes that a random point chooses.
template <Space S>
void MaRrdtStar<S>::restart_root(Arm& arm) {
  const TreeIndex t = groups_[arm.group].tree[index(arm.side)];
  arm.node = trees_.grid().nearest(
      random_point(), [&](NodeId n) -> const P& { return trees_.position(n); },
      [&](NodeId n) { return trees_.tree_of(n) == t; });
  arm.weight = full_weight;
  arm.sampler.reset();
}

/// One chained directed sample: extend the tree from its nearest node, and see which trees that brings
/// together.
template <Space S>
void MaRrdtStar<S>::grow(Arm& arm) {
  const TreeIndex t = trees_.tree_of(arm.node);
  const double radius = trees_.tree(t).radius;
  const P direction = arm.sampler.draw(random_);
  const P proposal = trees_.position(arm.node) + settings_.epsilon * direction;
  SampleCounts& counts = arm.group == no_group ? disjointed_counts_ : groups_[arm.group].counts;

  NodeId from = nearest_in_tree(proposal, t, arm.node);
  const bool known = is_known_ground(from, proposal, radius);
  if (known || !extends_from(from, arm, proposal, radius)) {
    if (!known) ++counts.invalid;
    arm.weight *= failure_factor;
    arm.sampler.failed(direction);
    return;
  }
  ++counts.valid;
  arm.sampler.succeeded(direction);
  if (arm.group == no_group) {
    arm.node = trees_.add_node(t, proposal);
    trees_.add_edge(from, arm.node);
    compare_disjointed_node(arm.node);
  } else {
    arm.node = add_root_node(arm.group, arm.side, proposal, from);
  }
}

template <Space S>
NodeId MaRrdtStar<S>::nearest_in_tree(const P& p, TreeIndex t, NodeId otherwise) const {
  NodeId best = otherwise;
  double best_squared = (trees_.position(otherwise) - p).squaredNorm();
  trees_.grid().for_each_near(p, [&](NodeId n) {
    const double squared = (trees_.position(n) - p).squaredNorm();
    if (squared < best_squared && trees_.tree_of(n) == t) {
      best = n;
      best_squared = squared;
    }
  });
  return best;
}

template <Space S>
bool MaRrdtStar<S>::is_known_ground(NodeId nearest, const P& p, double radius) const {
  return (trees_.position(nearest) - p).norm() < least_spacing * settings_.epsilon &&
         space_.segment_free(trees_.position(nearest), p, radius);
}

/// Whether the proposal can be reached from the nearest node or, behind a wall from that, from the arm's own.
template <Space S>
bool MaRrdtStar<S>::extends_from(NodeId& from, const Arm& arm, const P& proposal, double radius) const {
  if (space_.segment_free(trees_.position(from), proposal, radius)) return true;
  if (from == arm.node) return false;
  from = arm.node;
  return space_.segment_free(trees_.position(from), proposal, radius);
}

template <Space S>
auto MaRrdtStar<S>::random_point() -> P {
  const Box<D> box = space_.bounds();
  P p;
  for (int d = 0; d < D; ++d) p[d] = random_.uniform(box.lower[d], box.upper[d]);
  return p;
}

template <Space S>
auto MaRrdtStar<S>::random_free_point(double radius) -> std::optional<P> {
  for (int i = 0; i < free_point_tries; ++i) {
    const P p = random_point();
    if (space_.is_free(p, radius)) return p;
    ++disjointed_counts_.invalid;
  }
  return std::nullopt;
}

/// All nodes within epsilon of q, but for q itself.
template <Space S>
std::span<const NodeId> MaRrdtStar<S>::near(NodeId q) {
  near_.clear();
  const P& p = trees_.position(q);
  const double reach = settings_.epsilon * settings_.epsilon;
  trees_.grid().for_each_near(p, [&](NodeId n) {
    if (n != q && (trees_.position(n) - p).squaredNorm() <= reach) near_.push_back(n);
  });
  return near_;
}

/// MergeTrees for a node q of a disjointed tree: it takes in the active trees that q sees, and becomes
/// inactive if q sees a root tree of an open group or a tree that is inactive already.
template <Space S>
void MaRrdtStar<S>::compare_disjointed_node(NodeId q) {
  TreeIndex t = trees_.tree_of(q);
  const double radius = trees_.tree(t).radius;
  std::vector<TreeIndex> inactive;
  std::vector<std::pair<GroupIndex, Root>> roots;
  for (const NodeId n : near(q)) {
    const TreeIndex u = trees_.tree_of(n);
    const Tree& other = trees_.tree(u);
    if (u == t) continue;
    if (other.kind == TreeKind::active) {
      if (other.radius != radius || !visible(q, n, radius)) continue;
      trees_.add_edge(q, n);
      t = trees_.merge(t, u);
    } else if (other.kind == TreeKind::inactive) {
      if (std::ranges::count(inactive, u) || !visible(q, n, std::min(radius, other.radius))) continue;
      trees_.add_edge(q, n);
      inactive.push_back(u);
    } else {
      const std::pair root{other.group, other.side};
      if (!is_open(other.group) || other.radius > radius || std::ranges::count(roots, root)) continue;
      if (!visible(q, n, other.radius)) continue;
      trees_.add_edge(q, n);
      roots.push_back(root);
    }
  }
  if (inactive.empty() && roots.empty()) return;
  freeze(t);
  for (const TreeIndex u : inactive) link(t, u);
  for (const auto& [g, side] : roots) graft(g, side, t);
}

/// MergeTrees for a node q of a root tree: the disjointed trees that it sees are grafted, and where it sees
/// its partner, also one of the trees grafted to that, the group is solved.
template <Space S>
void MaRrdtStar<S>::compare_root_node(NodeId q, GroupIndex g, Root side) {
  const double radius = groups_[g].radius;
  for (const NodeId n : near(q)) {
    const TreeIndex u = trees_.tree_of(n);
    const Tree& other = trees_.tree(u);
    if (other.kind == TreeKind::root) {
      if (other.group != g || other.side == side || !visible(q, n, radius)) continue;
      trees_.add_edge(q, n);
      solve(g);
    } else {
      if (other.radius < radius || mark(groups_[g], u) == mark_of(side) || !visible(q, n, radius)) continue;
      trees_.add_edge(q, n);
      if (other.kind == TreeKind::active) freeze(u);
      graft(g, side, u);
    }
    if (!is_open(g)) return;
  }
}

template <Space S>
NodeId MaRrdtStar<S>::add_root_node(GroupIndex g, Root side, const P& p, NodeId from) {
  const NodeId q = trees_.add_node(groups_[g].tree[index(side)], p);
  if (from != no_node) choose_parent_and_rewire(q, from);
  groups_[g].fresh.push_back(q);
  compare_root_node(q, g, side);
  return q;
}

/// RRT* (Karaman, Frazzoli, 2011, Algorithm 6): the cheapest parent among the near nodes of the own tree,
/// then the near nodes whose way through q is shorter. Edges that were found to be free stay, for the path's
/// search.
template <Space S>
void MaRrdtStar<S>::choose_parent_and_rewire(NodeId q, NodeId from) {
  const TreeIndex t = trees_.tree_of(q);
  const double radius = trees_.tree(t).radius;
  auto distance = [&](NodeId n) { return (trees_.position(n) - trees_.position(q)).norm(); };
  std::vector<NodeId> seen;
  for (const NodeId n : near(q)) {
    if (n != from && trees_.tree_of(n) == t && visible(n, q, radius)) seen.push_back(n);
  }
  seen.push_back(from);
  const NodeId parent =
      *std::ranges::min_element(seen, std::less{}, [&](NodeId n) { return trees_.cost(n) + distance(n); });
  trees_.set_parent(q, parent, trees_.cost(parent) + distance(parent));
  for (const NodeId n : seen) {
    trees_.add_edge(q, n);
    const double through = trees_.cost(q) + distance(n);
    if (n == parent || through >= trees_.cost(n)) continue;
    trees_.set_parent(n, q, through);
    propagate_cost(n);
  }
}

template <Space S>
void MaRrdtStar<S>::propagate_cost(NodeId n) {
  std::vector<NodeId> changed{n};
  while (!changed.empty()) {
    const NodeId parent = changed.back();
    changed.pop_back();
    trees_.for_each_edge(parent, [&](const auto& edge) {
      if (trees_.parent(edge.to) != parent) return;
      const double length = (trees_.position(edge.to) - trees_.position(parent)).norm();
      trees_.set_parent(edge.to, parent, trees_.cost(parent) + length);
      changed.push_back(edge.to);
    });
  }
}

/// Straight towards the target as far as the way is free: on open ground that is the whole path.
template <Space S>
void MaRrdtStar<S>::connect_greedily(GroupIndex g, Root side, const P& target) {
  NodeId from = root(g, side);
  while (is_open(g)) {
    const P gap = target - trees_.position(from);
    if (gap.norm() < settings_.epsilon) return;
    const P next = trees_.position(from) + settings_.epsilon * gap.normalized();
    if (!space_.segment_free(trees_.position(from), next, groups_[g].radius)) return;
    ++groups_[g].counts.valid;
    from = add_root_node(g, side, next, from);
  }
}

template <Space S>
GroupIndex MaRrdtStar<S>::add_group(double radius) {
  const auto g = static_cast<GroupIndex>(groups_.size());
  Group& group = groups_.emplace_back();
  group.radius = radius;
  for (const Root side : {Root::start, Root::goal}) {
    group.tree[index(side)] = trees_.add_tree(TreeKind::root, radius, g, side);
  }
  open_.push_back(g);
  return g;
}

template <Space S>
void MaRrdtStar<S>::solve(GroupIndex g) {
  if (!is_open(g)) return;
  groups_[g].state = State::solved;
  leave(g);
}

template <Space S>
void MaRrdtStar<S>::leave(GroupIndex g) {
  std::erase(open_, g);
  some_group_left_ = true;
}

template <Space S>
void MaRrdtStar<S>::freeze(TreeIndex t) {
  trees_.tree(t).kind = TreeKind::inactive;
  frozen_.push_back(t);
}

template <Space S>
bool MaRrdtStar<S>::linked(TreeIndex a, TreeIndex b) const {
  const auto& links = trees_.tree(a).links;
  return std::ranges::find(links, b) != links.end();
}

/// Two inactive trees see each other: whoever grafted one has the other too.
template <Space S>
void MaRrdtStar<S>::link(TreeIndex a, TreeIndex b) {
  trees_.tree(a).links.push_back(b);
  trees_.tree(b).links.push_back(a);
  const double least_radius = std::min(trees_.tree(a).radius, trees_.tree(b).radius);
  for (std::size_t i = 0; i < open_.size();) {
    const GroupIndex g = open_[i];
    if (groups_[g].radius <= least_radius) {
      for (const Root side : {Root::start, Root::goal}) {
        if (mark(groups_[g], a) == mark_of(side)) graft(g, side, b);
        if (mark(groups_[g], b) == mark_of(side)) graft(g, side, a);
      }
    }
    if (i < open_.size() && open_[i] == g) ++i;  // solved groups have left the list
  }
}

/// Grafts an inactive tree to a root tree of g, and every tree that follows from that. Where a tree turns out
/// to be grafted to the partner, the root trees have met.
template <Space S>
void MaRrdtStar<S>::graft(GroupIndex g, Root side, TreeIndex t) {
  Group& group = groups_[g];
  group.marks.resize(std::max(group.marks.size(), trees_.tree_count()), Mark::none);
  std::vector<TreeIndex> joining{t};
  while (!joining.empty() && is_open(g)) {
    const TreeIndex u = joining.back();
    joining.pop_back();
    if (trees_.tree(u).radius < group.radius || group.marks[u] == mark_of(side)) continue;
    if (group.marks[u] != Mark::none) return solve(g);
    group.marks[u] = mark_of(side);
    ++group.grafted;
    const auto& links = trees_.tree(u).links;
    joining.insert(joining.end(), links.begin(), links.end());
  }
}

template <Space S>
TreeIndex MaRrdtStar<S>::add_inactive_tree(const FrozenTree<D>& frozen) {
  const TreeIndex t = trees_.add_tree(TreeKind::inactive, frozen.radius);
  std::vector<NodeId> ids;
  for (std::size_t i = 0; i < frozen.nodes.size(); ++i) {
    ids.push_back(trees_.add_node(t, frozen.nodes[i]));
    if (frozen.parents[i] >= 0) trees_.add_edge(ids[static_cast<std::size_t>(frozen.parents[i])], ids[i]);
  }
  for (const NodeId q : ids) {
    for (const NodeId n : near(q)) {
      const TreeIndex u = trees_.tree_of(n);
      const Tree& other = trees_.tree(u);
      if (u == t) continue;
      if (other.kind == TreeKind::root) {
        if (!is_open(other.group) || other.radius > frozen.radius) continue;
        if (mark(groups_[other.group], t) == mark_of(other.side) || !visible(q, n, other.radius)) continue;
        trees_.add_edge(q, n);
        graft(other.group, other.side, t);
      } else {
        if (linked(t, u) || !visible(q, n, std::min(frozen.radius, other.radius))) continue;
        trees_.add_edge(q, n);
        if (other.kind == TreeKind::active) freeze(u);
        link(t, u);
      }
    }
  }
  return t;
}

template <Space S>
auto MaRrdtStar<S>::path(GroupIndex g) -> std::vector<P> {
  if (!solved(g)) return {};
  const double radius = groups_[g].radius;
  auto usable = [&](const Tree& tree) {
    return tree.kind == TreeKind::inactive ? tree.radius >= radius
                                           : tree.kind == TreeKind::root && tree.group == g;
  };
  std::vector<P> points;
  for (const NodeId n : shortest_path(trees_, root(g, Root::start), root(g, Root::goal), usable, search_)) {
    points.push_back(trees_.position(n));
  }
  return points;
}

template <Space S>
std::size_t MaRrdtStar<S>::active_trees() const {
  std::size_t count = 0;
  for (TreeIndex t = 0; t < trees_.tree_count(); ++t) {
    count += trees_.is_tree(t) && trees_.tree(t).kind == TreeKind::active && trees_.tree(t).size > 0;
  }
  return count;
}

}  // namespace coppice
