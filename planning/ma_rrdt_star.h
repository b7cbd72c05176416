// MA-RRdT*: paths for many robots from trees that they share.
//
// Zhang, Wang, Meng, "Multi-robot Path Planning with Rapidly-exploring Random Disjointed-Trees", 2023,
// Algorithm 2; with one group it is Algorithm 1, RRdT* (after Lai, Ramos, Francis, 2019). What the paper
// leaves open, and what was chosen, is in docs/planning.md.
//
// A *group* is one robot's problem: two root trees, from its start and from its goal. *Disjointed* trees are
// rooted anywhere in free space. One that comes within epsilon and in sight of a root tree becomes
// *inactive*: it never changes again, and every group may graft it, to one of its two root trees. When the
// two root trees of a group meet, also through what they grafted, the group is solved: it stops growing and
// is left out of merging.
//
// Grafting is by reference: inactive trees that see each other are one component, and a group that grafted
// one tree of it has them all (forest.h), so what one group explored costs the next one next to nothing. A
// tree is compared only until it is connected: no two trees of one component are asked again whether they see
// each other. Costs-to-come inside of grafted trees are computed by the searches that matter, for the paths
// (path_search.h).
//
// Which trees grow *here* is up to the caller, so the same code is the whole planner in one process, the
// broker (disjointed trees here, root trees elsewhere) and an agent (its own root trees here, disjointed
// trees elsewhere).
//
// Metres. No clock: `step` is one iteration. Not thread-safe.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "planning/directed_sampler.h"
#include "planning/even_points.h"
#include "planning/forest.h"
#include "planning/frozen_tree.h"
#include "planning/path_search.h"
#include "planning/random.h"
#include "planning/rewiring.h"
#include "planning/space.h"
#include "planning/trees.h"

namespace coppice {

struct MaRrdtStarSettings {
  double epsilon = 0;  ///< longest step and largest distance over which trees meet, metres, above 0
  /// Disjointed trees that grow here at a time; 0: they grow elsewhere.
  std::size_t disjointed_trees = 16;
};

struct SampleCounts {
  std::uint32_t valid = 0;    ///< nodes that joined a tree
  std::uint32_t invalid = 0;  ///< samples that hit an obstacle
};

template <Space S>
class MaRrdtStar {
 public:
  static constexpr int D = S::dimension;
  using P = Point<D>;

  MaRrdtStar(const S& space, const MaRrdtStarSettings& settings, Random random)
      : space_(space),
        settings_(settings),
        random_(random),
        even_points_(space.bounds(), random_),
        trees_(space.bounds(), settings.epsilon) {}

  /// A group whose root trees grow here. Start and goal are free for `radius`.
  GroupIndex add_group(const P& start, const P& goal, double radius) {
    const GroupIndex g = add_group(radius);
    for (const auto& [side, p] : {std::pair(Root::start, start), std::pair(Root::goal, goal)}) {
      look_around(p);
      groups_[g].root_node[index(side)] = add_root_node(g, side, p, no_node);
    }
    for (const Root side : {Root::start, Root::goal}) arms_.push_back(Arm{root(g, side), g, side});
    // On open ground the straight line is all that is needed.
    if (is_open(g) && space_.segment_free(start, goal, radius)) {
      groups_[g].met = groups_[g].root_node;
      solve(g);
    }
    return g;
  }

  /// A group whose root trees grow elsewhere: add_remote_node tells of their nodes, close of their success.
  GroupIndex add_remote_group(double radius) { return add_group(radius); }

  void add_remote_node(GroupIndex g, Root side, const P& p) {
    if (!is_open(g)) return;
    look_around(p);
    compare_root_node(trees_.add_node(groups_[g].tree[index(side)], p), g, side);
  }

  /// The group needs no more trees: solved elsewhere, or given up.
  void close(GroupIndex g) {
    if (!is_open(g)) return;
    groups_[g].state = State::closed;
    leave(g);
  }

  /// Takes up an inactive tree that was grown elsewhere; parents come before their children.
  TreeIndex add_inactive_tree(const FrozenTree<D>& frozen);

  /// One iteration of Algorithm 2. False if nothing grows here or every group is solved.
  bool step();

  /// One iteration of growing disjointed trees for robots of `radius` before there is any group. False once
  /// the trees cover what such robots can reach: many free points in a row taught nothing, for each
  /// saw a tree and no two that are not connected (the end of Visibility-PRM: Simeon, Laumond, Nissoux,
  /// 2000). The trees are inactive then.
  bool grow_ahead(double radius);

  bool solved(GroupIndex g) const { return groups_[g].state == State::solved; }
  bool is_open(GroupIndex g) const { return groups_[g].state == State::open; }
  std::size_t open_groups() const { return open_.size(); }

  /// Start to goal along the trees' edges, the shortest way through the trees that met; empty while the group
  /// is not solved.
  std::vector<P> path(GroupIndex g);
  /// One for each group from `first` on, in less time: each along the shortest-path tree of one node, so not
  /// the shortest.
  std::vector<std::vector<P>> paths(std::size_t first = 0);
  std::size_t group_count() const { return groups_.size(); }

  std::uint32_t grafted_trees(GroupIndex g) const { return groups_[g].grafted; }
  /// Whether an inactive tree belongs to that root tree by now.
  bool has_grafted(GroupIndex g, Root side, TreeIndex t) const;
  TreeIndex root_tree(GroupIndex g, Root side) const { return groups_[g].tree[index(side)]; }
  SampleCounts group_counts(GroupIndex g) const { return groups_[g].counts; }
  SampleCounts disjointed_counts() const { return disjointed_counts_; }
  SampleCounts all_counts() const {
    SampleCounts sum = disjointed_counts_;
    for (const Group& group : groups_) {
      sum.valid += group.counts.valid;
      sum.invalid += group.counts.invalid;
    }
    return sum;
  }
  std::size_t active_trees() const;
  /// Calls fn(position, position) for each edge of the active trees, and for each node that has none with
  /// that twice.
  template <class Fn>
  void for_each_active_edge(Fn&& fn) const;

  /// Trees that became inactive since the last call, for publication.
  std::vector<TreeIndex> take_frozen() { return std::exchange(frozen_, {}); }
  std::uint32_t frozen_trees() const { return frozen_trees_; }  ///< so far
  FrozenTree<D> frozen_tree(TreeIndex t) const { return freeze_copy(trees_, t); }

  /// Nodes that joined a group's root trees here since the last call.
  std::vector<NodeId> take_root_nodes(GroupIndex g) { return std::exchange(groups_[g].fresh, {}); }

  const Trees<D>& trees() const { return trees_; }

 private:
  enum class State : std::uint8_t { open, solved, closed };

  /// Where a root tree sees a tree of the forest.
  struct Entry {
    TreeIndex tree;
    NodeId root_tree_node;
    NodeId forest_node;
  };
  struct Group {
    double radius = 0;
    Forest::Layer layer = 0;
    State state = State::open;
    std::array<TreeIndex, 2> tree{};
    std::array<NodeId, 2> root_node{no_node, no_node};
    std::array<std::vector<Entry>, 2> entries;    ///< one for each component that the root tree grafted
    std::array<NodeId, 2> met{no_node, no_node};  ///< the nodes by which the root trees see each other
    std::uint32_t grafted = 0;
    SampleCounts counts;
    std::vector<NodeId> fresh;
  };

  /// Where a tree grows: the node that the next sample starts from, and how promising that is.
  struct Arm {
    NodeId node = no_node;
    GroupIndex group = no_group;  ///< of a root tree
    Root side = Root::start;
    double weight = full_weight;
    DirectedSampler<D> sampler{};
  };

  static constexpr GroupIndex no_group = std::numeric_limits<GroupIndex>::max();
  static constexpr double full_weight = 10;
  static constexpr double failure_factor = 0.7;
  static constexpr double restart_weight = 0.1;
  /// A sample that near (in epsilon) to a node of its own tree, and in sight of it, teaches nothing.
  static constexpr double least_spacing = 0.25;
  static constexpr std::uint32_t few_nodes = 64;  // a tree of so many is looked through faster than the grid
  static constexpr int free_point_tries = 1000;   // a map with less free room than that restarts later
  // Points in a row: the larger the map, the smaller a part of it is the door that nobody saw yet.
  static constexpr std::size_t least_in_vain = 300;

  static constexpr std::size_t index(Root side) { return static_cast<std::size_t>(side); }
  NodeId root(GroupIndex g, Root side) const { return groups_[g].root_node[index(side)]; }

  GroupIndex add_group(double radius);
  void solve(GroupIndex g);
  void leave(GroupIndex g);

  // --- the iteration ---
  bool iterate();
  Arm* pick_tree();
  bool failing(const Arm& arm) const;
  double radius_of_new_tree();
  void restart(Arm& arm);
  bool teaches(const P& p, double radius) const;
  bool worth_a_node(const P& p, double radius);
  void restart_root(Arm& arm);
  void grow(Arm& arm);
  NodeId nearest_in_tree(const P& p, TreeIndex t, NodeId otherwise) const;
  bool is_known_ground(NodeId nearest, const P& p, double radius) const;
  bool extends_from(NodeId& from, const Arm& arm, const P& proposal, double radius) const;
  std::optional<P> next_free_point(double radius);

  // --- merging within epsilon ---
  void compare_disjointed_node(NodeId q);
  void compare_root_node(NodeId q, GroupIndex g, Root side);
  NodeId add_root_node(GroupIndex g, Root side, const P& p, NodeId from);
  std::vector<NodeId> seen_in_tree(NodeId q, NodeId from) const;
  void freeze(TreeIndex t);
  void link(TreeIndex a, TreeIndex b);
  void graft(GroupIndex g, Root side, const Entry& entry);
  bool connected(TreeIndex a, TreeIndex b) const;

  /// What a tree of shortest paths was grown for: it serves as long as the forest stays as it is, mission
  /// after mission.
  struct Ways {
    Forest::Layer layer = Forest::no_layer;
    TreeIndex component = 0;
    std::uint32_t disjointed_nodes = 0;
    std::uint32_t frozen_trees = 0;
    bool operator==(const Ways&) const = default;
  };

  // --- paths ---
  std::optional<std::pair<Entry, Entry>> meeting(GroupIndex g) const;
  std::vector<P> joined(const Entry& first, std::span<const NodeId> between, const Entry& last) const;
  /// The trees that robots of a radius may use on their way from one root tree to the other.
  static auto usable(double radius) {
    return [radius](const Tree& tree) { return tree.kind == TreeKind::inactive && tree.radius >= radius; };
  }
  std::vector<P> branch(NodeId n) const;
  void know_ways(const Ways& ways, NodeId from, NodeId to, double radius);

  bool visible(NodeId a, NodeId b, double radius) const {
    return space_.segment_free(trees_.position(a), trees_.position(b), radius);
  }
  void look_around(const P& p);

  const S& space_;
  MaRrdtStarSettings settings_;
  Random random_;
  EvenPoints<D> even_points_;
  Trees<D> trees_;
  Forest forest_;
  std::vector<Group> groups_;
  std::vector<GroupIndex> open_;
  std::vector<Arm> arms_;
  std::size_t disjointed_arms_ = 0;  ///< of arms_
  double ahead_radius_ = 0;          // of the trees that grow before there is a group
  int in_vain_ = 0;                  // points in a row that taught nothing
  SampleCounts disjointed_counts_;
  std::vector<TreeIndex> frozen_;
  std::uint32_t frozen_trees_ = 0;
  std::vector<NodeId> near_;  ///< what look_around saw
  SearchScratch search_;
  Ways ways_;
  SearchScratch ways_search_;
};

}  // namespace coppice

#include "planning/ma_rrdt_star_impl.h"
#include "planning/ma_rrdt_star_paths.h"
