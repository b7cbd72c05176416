// The bodies of ma_rrdt_star.h in the order of Algorithm 2: the loop, the samples, merging, grafting. The
// bodies of the paths are in ma_rrdt_star_paths.h, those of trees from and for other processes in
// ma_rrdt_star_exchange.h.
#pragma once

#include <limits>
#include <optional>

#include "planning/trees/ma_rrdt_star.h"

namespace coppice {

template <Space S>
bool MaRrdtStar<S>::step() {
  if (open_.empty()) return false;
  return iterate();
}

template <Space S>
bool MaRrdtStar<S>::grow_ahead(double radius) {
  if (std::exchange(ahead_radius_, radius) != radius) in_vain_ = 0;
  if (static_cast<std::size_t>(in_vain_) < std::max(least_in_vain, trees_.node_count())) {
    iterate();
    return true;
  }
  for (TreeIndex t = 0; t < trees_.tree_count(); ++t) {
    if (trees_.is_tree(t) && trees_.tree(t).kind == TreeKind::active && trees_.tree(t).size > 0) freeze(t);
  }
  return false;
}

template <Space S>
bool MaRrdtStar<S>::iterate() {
  if (disjointed_arms_ < parameters_.disjointed_trees) {
    arms_.resize(arms_.size() + parameters_.disjointed_trees - disjointed_arms_);
    disjointed_arms_ = parameters_.disjointed_trees;
  }
  Arm* const arm = pick_tree();
  if (arm == nullptr) return false;
  if (!failing(*arm)) {
    grow(*arm);
  } else if (arm->group == no_group) {
    restart(*arm);
  } else {
    restart_root(*arm);
  }
  return true;
}

/// Picks an arm at random in proportion to the weights: a uniform choice is kept with probability weight /
/// full weight. Arms of groups that need no more trees are removed when they are picked.
template <Space S>
auto MaRrdtStar<S>::pick_tree() -> Arm* {
  while (!arms_.empty()) {
    Arm& arm = arms_[random_.index(arms_.size())];
    if (arm.group != no_group && !is_open(arm.group)) {
      arm = arms_.back();
      arms_.pop_back();
      continue;
    }
    if (random_.uniform() * full_weight < arm.weight) return &arm;
  }
  return nullptr;
}

template <Space S>
bool MaRrdtStar<S>::failing(const Arm& arm) const {
  if (arm.node == no_node || arm.weight < parameters_.restart_weight) return true;
  return arm.group == no_group && trees_.tree(trees_.tree_of(arm.node)).kind != TreeKind::active;
}

/// The radius of a random group that still needs trees; a little more, if the tree then serves another one,
/// too.
template <Space S>
double MaRrdtStar<S>::radius_of_new_tree() {
  if (open_.empty()) return ahead_radius_;
  const double drawn = groups_[open_[random_.index(open_.size())]].radius;
  double radius = drawn;
  for (const GroupIndex g : open_) {
    const double other = groups_[g].radius;
    if (other <= alike * drawn) radius = std::max(radius, other);
  }
  return radius;
}

/// Starts a new disjointed tree at the next free point. If the point sees an active
/// tree, it becomes a node of that tree. If it sees a root tree or an inactive tree, it becomes an inactive
/// tree of one node.
template <Space S>
void MaRrdtStar<S>::restart(Arm& arm) {
  const double radius = radius_of_new_tree();
  const std::optional<P> p = next_free_point(radius);
  if (!p) {
    ++in_vain_;
    return;
  }
  look_around(*p);
  if (open_.empty()) in_vain_ = teaches(*p, radius) ? 0 : in_vain_ + 1;
  if (!worth_a_node(*p, radius)) return;
  ++disjointed_counts_.valid;
  arm = Arm{trees_.add_node(trees_.add_tree(TreeKind::active, radius), *p)};
  compare_disjointed_node(arm.node);
}

/// Whether a point sees no tree, or sees two trees that are not connected yet for robots of that radius.
template <Space S>
bool MaRrdtStar<S>::teaches(const P& p, double radius) const {
  std::optional<TreeIndex> seen;
  for (const NodeId n : near_) {
    const TreeIndex t = trees_.tree_of(n);
    const Tree& tree = trees_.tree(t);
    if (tree.kind == TreeKind::root || tree.radius < radius) continue;
    if (seen && (*seen == t || connected(*seen, t, radius))) continue;
    if (!space_.segment_free(trees_.position(n), p, radius)) continue;
    if (seen) return true;
    seen = t;
  }
  return !seen;
}

/// The more nodes of shared trees a point sees close by, the less likely it is to be kept, since it brings
/// less. So the density of nodes stays bounded, yet no point is excluded for ever, which would break
/// completeness.
template <Space S>
bool MaRrdtStar<S>::worth_a_node(const P& p, double radius) {
  const double reach = parameters_.spacing * parameters_.epsilon;
  // Drawn first, so that counting may stop as soon as the result is certain.
  const double u = random_.uniform();
  int seen = 0;
  for (const NodeId n : near_) {
    const P& place = trees_.position(n);
    if ((place - p).squaredNorm() >= reach * reach) continue;
    const Tree& tree = trees_.tree(trees_.tree_of(n));
    if (tree.kind == TreeKind::root || tree.radius < radius) continue;
    if (!space_.segment_free(place, p, radius)) continue;
    ++seen;
    if (u * (1 + seen) * (1 + seen) >= 1) return false;
  }
  return true;
}

/// A root tree cannot be restarted at another root. It continues from its node that is nearest to a random
/// point.
template <Space S>
void MaRrdtStar<S>::restart_root(Arm& arm) {
  const TreeIndex t = groups_[arm.group].tree[index(arm.side)];
  const P p = random_point(space_.bounds(), random_);
  if (trees_.tree(t).size <= few_nodes) {
    double least = std::numeric_limits<double>::infinity();
    trees_.for_each_node(t, [&](NodeId n) {
      const double squared = (trees_.position(n) - p).squaredNorm();
      if (squared >= least) return;
      least = squared;
      arm.node = n;
    });
  } else {
    arm.node = trees_.grid().nearest(p, [&](NodeId n) { return trees_.tree_of(n) == t; });
  }
  arm.weight = full_weight;
  arm.sampler.reset();
}

/// Draws one chained directed sample: extends the tree from its nearest node, and merges the trees that meet
/// by that.
template <Space S>
void MaRrdtStar<S>::grow(Arm& arm) {
  const TreeIndex t = trees_.tree_of(arm.node);
  const double radius = trees_.tree(t).radius;
  const P direction = arm.sampler.draw(random_, parameters_.kappa);
  const P proposal = trees_.position(arm.node) + parameters_.epsilon * direction;
  SampleCounts& counts = arm.group == no_group ? disjointed_counts_ : groups_[arm.group].counts;

  // Most failing samples fail here, before any look-up.
  bool known = false;
  bool joins = space_.is_free(proposal, radius);
  NodeId from = arm.node;
  if (joins) {
    look_around(proposal);
    from = nearest_in_tree(proposal, t, arm.node);
    known = is_known_ground(from, proposal, radius);
    joins = !known && extends_from(from, arm, proposal, radius);
  }
  if (!joins) {
    if (!known) ++counts.invalid;
    arm.weight *= parameters_.failure_factor;
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

/// The nearest node of the tree among the nodes around p; `otherwise` if that is nearer.
template <Space S>
NodeId MaRrdtStar<S>::nearest_in_tree(const P& p, TreeIndex t, NodeId otherwise) const {
  NodeId best = otherwise;
  double best_squared = (trees_.position(otherwise) - p).squaredNorm();
  for (const NodeId n : near_) {
    const double squared = (trees_.position(n) - p).squaredNorm();
    if (squared >= best_squared || trees_.tree_of(n) != t) continue;
    best = n;
    best_squared = squared;
  }
  return best;
}

template <Space S>
bool MaRrdtStar<S>::is_known_ground(NodeId nearest, const P& p, double radius) const {
  return (trees_.position(nearest) - p).norm() < parameters_.spacing * parameters_.epsilon &&
         space_.segment_free(trees_.position(nearest), p, radius);
}

/// Whether the proposal can be reached from the nearest node or, if a wall hides it, from the arm's own node.
template <Space S>
bool MaRrdtStar<S>::extends_from(NodeId& from, const Arm& arm, const P& proposal, double radius) const {
  if (space_.segment_free(trees_.position(from), proposal, radius)) return true;
  if (from == arm.node) return false;
  from = arm.node;
  return space_.segment_free(trees_.position(from), proposal, radius);
}

template <Space S>
auto MaRrdtStar<S>::next_free_point(double radius) -> std::optional<P> {
  for (int i = 0; i < free_point_tries; ++i) {
    const P p =
        parameters_.restarts == Restarts::even ? even_points_.next() : random_point(space_.bounds(), random_);
    if (space_.is_free(p, radius)) return p;
    ++disjointed_counts_.invalid;
  }
  return std::nullopt;
}

/// Collects in near_ the nodes within epsilon of p. A new node at p is compared with them.
template <Space S>
void MaRrdtStar<S>::look_around(const P& p) {
  trees_.grid().collect_near(p, parameters_.epsilon, near_);
}

/// MergeTrees for a node q of a disjointed tree. The tree takes in the active trees that q sees. It becomes
/// inactive if q sees a root tree of an open group or an inactive tree.
template <Space S>
void MaRrdtStar<S>::compare_disjointed_node(NodeId q) {
  TreeIndex t = trees_.tree_of(q);
  const double radius = trees_.tree(t).radius;
  std::vector<std::pair<GroupIndex, Entry>> roots;
  for (const NodeId n : near_) {
    const TreeIndex u = trees_.tree_of(n);
    const Tree& other = trees_.tree(u);
    if (u == t) continue;
    if (other.kind == TreeKind::active) {
      // take_frozen() links a tree that has just become inactive to active ones, once these are inactive too.
      if (trees_.tree(t).kind != TreeKind::active || other.radius != radius || !visible(q, n, radius))
        continue;
      trees_.add_edge(q, n);
      t = trees_.merge(t, u);
    } else if (other.kind == TreeKind::inactive) {
      if (connected(t, u) || !visible(q, n, std::min(radius, other.radius))) continue;
      freeze(t);
      link(q, n);
    } else if (is_open(other.group) && other.radius <= radius) {
      roots.push_back({other.group, {t, n, q}});
    }
  }
  for (auto& [g, entry] : roots) {
    entry.tree = t;
    const Root side = trees_.tree(trees_.tree_of(entry.root_tree_node)).side;
    if (!is_open(g) || has_grafted(g, side, t) || !visible(q, entry.root_tree_node, groups_[g].radius))
      continue;
    trees_.add_edge(q, entry.root_tree_node);
    freeze(t);
    graft(g, side, entry);
  }
}

/// MergeTrees for a node q of a root tree. The disjointed trees that q sees are grafted. If q sees the
/// partner tree, or a tree grafted to the partner, the group is solved.
template <Space S>
void MaRrdtStar<S>::compare_root_node(NodeId q, GroupIndex g, Root side) {
  const double radius = groups_[g].radius;
  for (const NodeId n : near_) {
    const TreeIndex u = trees_.tree_of(n);
    const Tree& other = trees_.tree(u);
    if (other.kind == TreeKind::root) {
      if (other.group != g || other.side == side || !visible(q, n, radius)) continue;
      groups_[g].met[index(side)] = q;
      groups_[g].met[index(other.side)] = n;
      solve(g);
    } else {
      if (other.radius < radius || has_grafted(g, side, u) || !visible(q, n, radius)) continue;
      trees_.add_edge(q, n);
      freeze(u);
      graft(g, side, {u, q, n});
    }
    if (!is_open(g)) return;
  }
}

template <Space S>
NodeId MaRrdtStar<S>::add_root_node(GroupIndex g, Root side, const P& p, NodeId from) {
  const NodeId q = trees_.add_node(groups_[g].tree[index(side)], p);
  extend_reach(g, side, p);
  if (from != no_node) choose_parent_and_rewire<D>(trees_, q, seen_in_tree(q, from));
  groups_[g].fresh.push_back(q);
  compare_root_node(q, g, side);
  return q;
}

template <Space S>
void MaRrdtStar<S>::extend_reach(GroupIndex g, Root side, const P& p) {
  std::optional<Box<D>>& reach = groups_[g].reach[index(side)];
  reach = reach ? extended(*reach, p) : Box<D>{p, p};
}

/// The nodes of q's own tree that may become its parent, or be rewired to it.
template <Space S>
std::vector<NodeId> MaRrdtStar<S>::seen_in_tree(NodeId q, NodeId from) const {
  const TreeIndex t = trees_.tree_of(q);
  const double radius = trees_.tree(t).radius;
  std::vector<NodeId> seen;
  for (const NodeId n : near_) {
    if (n != from && trees_.tree_of(n) == t && visible(n, q, radius)) seen.push_back(n);
  }
  seen.push_back(from);
  return seen;
}

template <Space S>
GroupIndex MaRrdtStar<S>::add_group(double radius) {
  const auto g = static_cast<GroupIndex>(groups_.size());
  Group& group = groups_.emplace_back();
  group.radius = radius;
  group.layer = forest_.layer(radius);
  for (const Root side : {Root::start, Root::goal}) {
    group.tree[index(side)] = trees_.add_tree(TreeKind::root, radius, g, side);
  }
  open_.push_back(g);
  return g;
}

template <Space S>
void MaRrdtStar<S>::solve(GroupIndex g) {
  if (!is_open(g)) return;
  Group& group = groups_[g];
  group.state = State::solved;
  // The component through which the root trees meet belongs to both sides, but counts once.
  std::vector<TreeIndex> components;
  for (const auto& entries : group.entries) {
    for (const Entry& entry : entries) {
      const TreeIndex c = forest_.component(group.layer, entry.tree);
      if (std::ranges::count(components, c) == 0) components.push_back(c);
    }
  }
  for (const TreeIndex c : components) group.grafted += forest_.trees_in(group.layer, c);
  leave(g);
}

template <Space S>
void MaRrdtStar<S>::leave(GroupIndex g) {
  std::erase(open_, g);
}

/// The tree never changes from now on.
template <Space S>
void MaRrdtStar<S>::freeze(TreeIndex t) {
  if (trees_.tree(t).kind == TreeKind::inactive) return;
  trees_.tree(t).kind = TreeKind::inactive;
  frozen_.push_back(t);
  ++frozen_trees_;
}

/// Whether all robots up to `radius` that may use both trees have grafted both as soon as they have grafted
/// one.
template <Space S>
bool MaRrdtStar<S>::connected(TreeIndex a, TreeIndex b, double radius) const {
  const auto layer = forest_.layer_within(radius);
  return layer == Forest::no_layer || forest_.component(layer, a) == forest_.component(layer, b);
}

template <Space S>
bool MaRrdtStar<S>::has_grafted(GroupIndex g, Root side, TreeIndex t) const {
  const Group& group = groups_[g];
  const TreeIndex c = forest_.component(group.layer, t);
  return std::ranges::any_of(group.entries[index(side)], [&](const Entry& entry) {
    return forest_.component(group.layer, entry.tree) == c;
  });
}

/// The inactive trees of two nodes see each other. A root tree that grafted one of them has the other too. A
/// group whose two root trees grafted one each is solved.
template <Space S>
void MaRrdtStar<S>::link(NodeId p, NodeId q) {
  trees_.add_edge(p, q);
  const TreeIndex a = trees_.tree_of(p);
  const TreeIndex b = trees_.tree_of(q);
  std::vector<GroupIndex> met;
  const double radius = std::min(trees_.tree(a).radius, trees_.tree(b).radius);
  forest_.link(a, b, radius, [&](Forest::Layer, const Forest::Graft& graft) {
    const Root other = partner_of(graft.side);
    if (is_open(graft.group) && (has_grafted(graft.group, other, a) || has_grafted(graft.group, other, b)))
      met.push_back(graft.group);
  });
  for (const GroupIndex g : met) solve(g);
}

/// Grafts the component of an inactive tree to a root tree of g. If it is already grafted to the partner, the
/// root trees have met.
template <Space S>
void MaRrdtStar<S>::graft(GroupIndex g, Root side, const Entry& entry) {
  Group& group = groups_[g];
  group.entries[index(side)].push_back(entry);
  forest_.graft(group.layer, entry.tree, {g, side});
  if (has_grafted(g, partner_of(side), entry.tree)) solve(g);
}

}  // namespace coppice
