// MA-RRdT*: paths for many robots from shared trees.
//
// Zhang, Wang, Meng, "Multi-robot Path Planning with Rapidly-exploring Random Disjointed-Trees", 2023,
// Algorithm 2; with one group it is Algorithm 1, RRdT* (after Lai, Ramos, Francis, 2019). docs/planning.md
// lists what the paper leaves open and what was chosen.
//
// A *group* is the problem of one robot: two root trees, from its start and from its goal. *Disjointed* trees
// are rooted anywhere in free space. A disjointed tree that comes within epsilon and in sight of a root tree
// becomes *inactive*: it never changes again, and every group may graft it to one of its two root trees. When
// the two root trees of a group meet, directly or through grafted trees, the group is solved: it stops
// growing and takes no further part in merging.
//
// Grafting is by reference: inactive trees that see each other form a component, and a group that grafted one
// tree of a component has all of them (forest.h). So a group uses what other groups explored at almost no
// cost. Visibility between two trees is tested only until they are connected. Costs-to-come inside of grafted
// trees are computed only by the searches for paths (path_search.h).
//
// The caller chooses which trees grow *here*. So the same code is the whole planner in one process, the
// broker (disjointed trees grow here, root trees elsewhere) and an agent (its root trees grow here,
// disjointed trees elsewhere).
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

#include "coppice/planning/plan_paths.h"
#include "coppice/planning/random.h"
#include "coppice/planning/tree_parameters.h"
#include "planning/geometry/even_points.h"
#include "planning/geometry/space.h"
#include "planning/trees/directed_sampler.h"
#include "planning/trees/forest.h"
#include "planning/trees/frozen_trees.h"
#include "planning/trees/path_search.h"
#include "planning/trees/rewiring.h"
#include "planning/trees/trees.h"

namespace coppice {

template <Space S>
class MaRrdtStar {
 public:
  static constexpr int D = S::dimension;
  using P = Point<D>;

  /// `parameters`: an epsilon above 0; 0 disjointed trees means that they grow elsewhere.
  MaRrdtStar(const S& space, const TreeParameters& parameters, Random random)
      : space_(space),
        parameters_(parameters),
        random_(random),
        even_points_(space.bounds(), random_),
        trees_(space.bounds(), parameters.epsilon) {}

  /// Adds a group whose root trees grow here. Start and goal must be free for `radius`.
  GroupIndex add_group(const P& start, const P& goal, double radius) {
    const GroupIndex g = add_group(radius);
    for (const auto& [side, p] : {std::pair(Root::start, start), std::pair(Root::goal, goal)}) {
      look_around(p);
      groups_[g].root_node[index(side)] = add_root_node(g, side, p, no_node);
    }
    for (const Root side : {Root::start, Root::goal}) arms_.push_back(Arm{root(g, side), g, side});
    // In open space the straight line is enough.
    if (is_open(g) && space_.segment_free(start, goal, radius)) {
      groups_[g].met = groups_[g].root_node;
      solve(g);
    }
    return g;
  }

  /// Adds a group whose root trees grow elsewhere: add_remote_node adds their nodes, and close tells that the
  /// group is solved.
  GroupIndex add_remote_group(double radius) { return add_group(radius); }

  void add_remote_node(GroupIndex g, Root side, const P& p) {
    if (!is_open(g)) return;
    look_around(p);
    const NodeId q = trees_.add_node(groups_[g].tree[index(side)], p);
    extend_reach(g, side, p);
    compare_root_node(q, g, side);
  }

  /// The group needs no more trees: it was solved elsewhere or given up.
  void close(GroupIndex g) {
    if (!is_open(g)) return;
    groups_[g].state = State::closed;
    leave(g);
  }

  /// Adds inactive trees that were grown elsewhere, and grafts those that root trees here see. Parents must
  /// come before their children. Returns the first node; the others are numbered from it in their order.
  NodeId add_inactive_trees(const FrozenTrees<D>& frozen);
  /// Links the trees of two nodes that were found elsewhere to see each other. Does nothing if an obstacle is
  /// between them.
  void add_link(NodeId a, NodeId b);
  /// Links the inactive trees whose nodes are numbered from `first` on to all inactive trees that they see.
  /// Active trees that they see become inactive.
  void look_for_links(NodeId first);

  /// Runs one iteration of Algorithm 2. Returns false if no tree grows here or every group is solved.
  bool step();

  /// Runs one iteration of growing disjointed trees for robots of `radius` before there is any group. Returns
  /// false once the trees cover what such robots can reach, that is, when many consecutive free points
  /// brought nothing new: each saw a tree (the end of Visibility-PRM: Simeon, Laumond, Nissoux, 2000). Where
  /// robots of that radius have had a group, two trees without a link are news, too. The trees are inactive
  /// then.
  bool grow_ahead(double radius);

  bool solved(GroupIndex g) const { return groups_[g].state == State::solved; }
  bool is_open(GroupIndex g) const { return groups_[g].state == State::open; }
  std::size_t open_groups() const { return open_.size(); }

  /// The path from start to goal along the trees' edges, the shortest one through the trees that met. Empty
  /// while the group is not solved.
  std::vector<P> path(GroupIndex g);
  /// A path for each group from `first` on, in less time: each follows the shortest-path tree of one node, so
  /// it need not be the shortest.
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
  /// Calls fn(position, position) for each edge of the active trees. For a tree of one node, both positions
  /// are that node's.
  template <class Fn>
  void for_each_active_edge(Fn&& fn) const;

  /// Trees that became inactive since the last call, for publication. Of these and all earlier ones, those
  /// that see each other are linked.
  std::vector<TreeIndex> take_frozen();
  /// Number of trees that have become inactive so far.
  std::uint32_t frozen_trees() const { return frozen_trees_; }

  /// Nodes that joined a group's root trees here since the last call.
  std::vector<NodeId> take_root_nodes(GroupIndex g) { return std::exchange(groups_[g].fresh, {}); }

  const Trees<D>& trees() const { return trees_; }

 private:
  enum class State : std::uint8_t { open, solved, closed };

  /// The pair of nodes at which a root tree sees a tree of the forest.
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
    std::array<std::optional<Box<D>>, 2> reach{};  ///< the box around the nodes of each root tree
    std::array<std::vector<Entry>, 2> entries;     ///< one for each component that the root tree grafted
    std::array<NodeId, 2> met{no_node, no_node};   ///< the nodes through which the root trees see each other
    std::uint32_t grafted = 0;
    SampleCounts counts;
    std::vector<NodeId> fresh;
  };

  /// The growing end of a tree: the node from which the next sample starts, and its weight.
  struct Arm {
    NodeId node = no_node;
    GroupIndex group = no_group;  ///< of a root tree; otherwise no_group
    Root side = Root::start;
    double weight = full_weight;
    DirectedSampler<D> sampler{};
  };

  static constexpr GroupIndex no_group = std::numeric_limits<GroupIndex>::max();
  // A tree of at most so many nodes is searched faster without the grid.
  static constexpr std::uint32_t few_nodes = 64;
  // A tree for one group also serves another one whose radius is at most so many times as large. Differential
  // robots of one size differ that little, by what they are beside their chords.
  static constexpr double alike = 1.01;
  // If the map has less free space than that, the restart happens later.
  static constexpr int free_point_tries = 1000;
  // Consecutive points without anything new that end growing ahead, at least. The number of nodes counts too:
  // the larger the map, the smaller a part of it is a door that no point has seen yet.
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
  void extend_reach(GroupIndex g, Root side, const P& p);
  bool is_near_root_trees(const P& p) const;
  void freeze(TreeIndex t);
  void link(NodeId p, NodeId q);
  void link_to_seen_trees(NodeId q);
  void graft(GroupIndex g, Root side, const Entry& entry);
  void graft_to_root_trees(NodeId q);
  bool connected(TreeIndex a, TreeIndex b, double radius) const;
  bool connected(TreeIndex a, TreeIndex b) const {
    return connected(a, b, std::min(trees_.tree(a).radius, trees_.tree(b).radius));
  }

  /// The key of a tree of shortest paths. The tree is valid for as long as the forest does not change, for
  /// many missions.
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
  TreeParameters parameters_;
  Random random_;
  EvenPoints<D> even_points_;
  Trees<D> trees_;
  Forest forest_;
  std::vector<Group> groups_;
  std::vector<GroupIndex> open_;
  std::vector<Arm> arms_;
  std::size_t disjointed_arms_ = 0;  ///< number of arms_ that grow disjointed trees
  double ahead_radius_ = 0;          // radius of the trees that grow before there is a group, metres
  int in_vain_ = 0;                  // consecutive points that brought nothing new
  SampleCounts disjointed_counts_;
  std::vector<TreeIndex> frozen_;
  std::uint32_t frozen_trees_ = 0;
  std::vector<NodeId> near_;  ///< the nodes that the last look_around() found
  SearchScratch search_;
  Ways ways_;
  SearchScratch ways_search_;
};

}  // namespace coppice

#include "planning/trees/ma_rrdt_star_exchange.h"
#include "planning/trees/ma_rrdt_star_impl.h"
#include "planning/trees/ma_rrdt_star_paths.h"
