#include "planning/trees/ma_rrdt_star.h"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/clearance_field.h"
#include "planning/geometry/line_of_sight.h"

namespace coppice {
namespace {

using Planner = MaRrdtStar<ClearanceField>;

/// A map from its picture: '#' is blocked. Each character is a block of `scale` x `scale` cells.
OccupancyMap picture(const std::vector<std::string>& rows, int scale = 1) {
  OccupancyMap map;
  map.width = static_cast<int>(rows.front().size()) * scale;
  map.height = static_cast<int>(rows.size()) * scale;
  for (int j = 0; j < map.height; ++j) {
    for (int i = 0; i < map.width; ++i) {
      map.blocked.push_back(rows[static_cast<std::size_t>(j / scale)][static_cast<std::size_t>(i / scale)] ==
                            '#');
    }
  }
  return map;
}

/// Two rooms with a door 20 m wide between them.
OccupancyMap two_rooms() {
  return picture({"..........#.........", "..........#.........", "..........#.........",
                  "....................", "..........#.........", "..........#........."},
                 20);
}

void run(Planner& planner, int most = 200'000) {
  for (int i = 0; i < most && planner.step(); ++i) {
  }
}

void expect_valid_path(const Path& path, const Point2& start, const Point2& goal, double radius,
                       const ClearanceField& field) {
  ASSERT_GE(path.size(), 2u);
  EXPECT_EQ(path.front(), start);
  EXPECT_EQ(path.back(), goal);
  for (std::size_t i = 1; i < path.size(); ++i) EXPECT_TRUE(field.segment_free(path[i - 1], path[i], radius));
}

TEST(MaRrdtStar, AStraightPathNeedsNoDisjointedTree) {
  const ClearanceField field(picture({"....", "....", "...."}, 50));
  Planner planner(field, {.epsilon = 20, .disjointed_trees = 16}, Random(1));
  const GroupIndex g = planner.add_group({10, 10}, {180, 140}, 5);
  EXPECT_TRUE(planner.solved(g));
  EXPECT_EQ(planner.disjointed_counts().valid, 0u);
  EXPECT_NEAR(length_of(planner.path(g)), std::hypot(170, 130), 1e-6);
}

TEST(MaRrdtStar, EveryGroupFindsAPathThroughTheDoor) {
  const ClearanceField field(two_rooms());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Planner planner(field, {.epsilon = 40, .disjointed_trees = 16}, Random(seed));
    const std::vector<std::pair<Point2, Point2>> tasks{
        {{20, 20}, {380, 20}}, {{380, 100}, {20, 100}}, {{100, 20}, {300, 110}}};
    for (const auto& [start, goal] : tasks) planner.add_group(start, goal, 8);
    run(planner);
    for (GroupIndex g = 0; g < tasks.size(); ++g) {
      ASSERT_TRUE(planner.solved(g)) << "seed " << seed;
      expect_valid_path(planner.path(g), tasks[g].first, tasks[g].second, 8, field);
      expect_valid_path(optimise_line_of_sight(field, planner.path(g), 8), tasks[g].first, tasks[g].second, 8,
                        field);
    }
  }
}

TEST(MaRrdtStar, TheSameSeedGivesTheSamePaths) {
  const ClearanceField field(two_rooms());
  std::vector<Path> paths;
  for (int k = 0; k < 2; ++k) {
    Planner planner(field, {.epsilon = 30, .disjointed_trees = 16}, Random(7));
    const GroupIndex g = planner.add_group({20, 20}, {380, 20}, 8);
    run(planner);
    paths.push_back(planner.path(g));
  }
  EXPECT_EQ(paths[0], paths[1]);
}

TEST(MaRrdtStar, ASolvedGroupGrowsNoFurther) {
  const ClearanceField field(two_rooms());
  Planner planner(field, {.epsilon = 30, .disjointed_trees = 16}, Random(3));
  const GroupIndex quick = planner.add_group({20, 20}, {60, 20}, 8);
  const GroupIndex slow = planner.add_group({20, 20}, {380, 20}, 8);
  ASSERT_TRUE(planner.solved(quick));
  const std::uint32_t before = planner.group_counts(quick).valid;
  const std::uint32_t grafted = planner.grafted_trees(quick);
  run(planner);
  ASSERT_TRUE(planner.solved(slow));
  EXPECT_EQ(planner.group_counts(quick).valid, before);
  EXPECT_EQ(planner.grafted_trees(quick), grafted);
}

TEST(MaRrdtStar, ThePlannerHasNothingToDoOnceAllGroupsAreSolved) {
  const ClearanceField field(picture({"...."}, 50));
  Planner planner(field, {.epsilon = 20, .disjointed_trees = 4}, Random(1));
  EXPECT_FALSE(planner.step());
  planner.add_group({10, 10}, {190, 40}, 5);
  EXPECT_FALSE(planner.step());
}

TEST(MaRrdtStar, TreesGrownForOneGroupServeTheNext) {
  const ClearanceField field(two_rooms());
  Planner planner(field, {.epsilon = 40, .disjointed_trees = 16}, Random(5));
  planner.add_group({20, 20}, {380, 20}, 8);
  run(planner);
  const SampleCounts before = planner.disjointed_counts();
  const GroupIndex second = planner.add_group({30, 100}, {370, 100}, 8);
  run(planner);
  ASSERT_TRUE(planner.solved(second));
  EXPECT_GT(planner.grafted_trees(second), 0u);
  EXPECT_LE(planner.disjointed_counts().valid - before.valid, before.valid / 2 + 5);
}

/// The nodes of some trees, with edges between them.
FrozenTrees<2> frozen_trees_of(const Planner& planner, const std::vector<NodeId>& nodes) {
  const Trees<2>& trees = planner.trees();
  FrozenTrees<2> frozen{
      .radius = trees.tree(trees.tree_of(nodes.front())).radius, .nodes = {}, .parents = {}};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    frozen.nodes.push_back(trees.position(nodes[i]));
    frozen.parents.push_back(-1);
    trees.for_each_edge(nodes[i], [&](const auto& edge) {
      const auto earlier = std::find(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(i), edge.to);
      if (trees.tree_of(edge.to) == trees.tree_of(nodes[i]) && *earlier == edge.to)
        frozen.parents.back() = static_cast<std::int32_t>(earlier - nodes.begin());
    });
  }
  return frozen;
}

/// Takes the trees that have become inactive from the broker to the agent, with their links. `sent`: the
/// agent's nodes, by the broker's.
void publish(Planner& broker, Planner& agent, std::map<NodeId, NodeId>& sent) {
  std::vector<NodeId> fresh;
  for (const TreeIndex t : broker.take_frozen()) {
    const std::vector<NodeId> nodes = breadth_first(broker.trees(), t);
    const NodeId first = agent.add_inactive_trees(frozen_trees_of(broker, nodes));
    for (std::size_t i = 0; i < nodes.size(); ++i) sent[nodes[i]] = first + static_cast<NodeId>(i);
    fresh.insert(fresh.end(), nodes.begin(), nodes.end());
  }
  for (const NodeId n : fresh) {
    broker.trees().for_each_edge(n, [&](const auto& edge) {
      if (sent.contains(edge.to)) agent.add_link(sent[n], sent[edge.to]);
    });
  }
}

// The halves of broker and agent, with calls instead of the messages between them.
TEST(MaRrdtStar, BrokerAndAgentTogetherFindAPath) {
  const ClearanceField field(two_rooms());
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Planner broker(field, {.epsilon = 40, .disjointed_trees = 16}, Random(seed));
    Planner agent(field, {.epsilon = 40, .disjointed_trees = 0}, Random(seed + 100));
    const GroupIndex there = broker.add_remote_group(8);
    const GroupIndex here = agent.add_group({20, 20}, {380, 20}, 8);
    std::map<NodeId, NodeId> sent;
    for (int round = 0; round < 2000 && !agent.solved(here); ++round) {
      for (const NodeId n : agent.take_root_nodes(here)) {
        const Tree& tree = agent.trees().tree(agent.trees().tree_of(n));
        broker.add_remote_node(there, tree.side, agent.trees().position(n));
      }
      for (int i = 0; i < 50; ++i) broker.step();
      publish(broker, agent, sent);
      agent.step();
    }
    ASSERT_TRUE(agent.solved(here)) << "seed " << seed;
    EXPECT_GT(agent.grafted_trees(here), 0u);
    expect_valid_path(agent.path(here), {20, 20}, {380, 20}, 8, field);
    broker.close(there);
    EXPECT_FALSE(broker.step());
  }
}

TEST(MaRrdtStar, SmallRobotsUseTreesOfLargeRobotsButNotViceVersa) {
  const ClearanceField field(two_rooms());
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Planner planner(field, {.epsilon = 30, .disjointed_trees = 16}, Random(seed));
    const GroupIndex small = planner.add_group({20, 20}, {380, 20}, 2);
    const GroupIndex large = planner.add_group({20, 100}, {380, 100}, 9);
    run(planner);
    ASSERT_TRUE(planner.solved(small) && planner.solved(large));
    expect_valid_path(planner.path(small), {20, 20}, {380, 20}, 2, field);
    expect_valid_path(planner.path(large), {20, 100}, {380, 100}, 9, field);
  }
}

TEST(MaRrdtStar, AFrozenTreeListsParentsFirstAndKeepsItsClearance) {
  const ClearanceField field(two_rooms());
  Planner planner(field, {.epsilon = 30, .disjointed_trees = 16}, Random(2));
  planner.add_group({20, 20}, {380, 20}, 8);
  run(planner);
  const auto frozen = planner.take_frozen();
  ASSERT_FALSE(frozen.empty());
  for (const TreeIndex t : frozen) {
    const std::vector<NodeId> nodes = breadth_first(planner.trees(), t);
    ASSERT_EQ(nodes.size(), planner.trees().tree(t).size);
    const FrozenTrees<2> tree = frozen_trees_of(planner, nodes);
    EXPECT_EQ(tree.parents.front(), -1);
    for (std::size_t i = 1; i < tree.nodes.size(); ++i) {
      ASSERT_GE(tree.parents[i], 0);
      ASSERT_LT(tree.parents[i], static_cast<std::int32_t>(i));
      EXPECT_TRUE(
          field.segment_free(tree.nodes[static_cast<std::size_t>(tree.parents[i])], tree.nodes[i], 8));
    }
  }
}

TEST(MaRrdtStar, OnlyALinkThatNoObstacleBlocksConnectsTrees) {
  const ClearanceField field(two_rooms());  // the wall: x = 200 to 220; its door: y = 60 to 80
  Planner planner(field, {.epsilon = 100, .disjointed_trees = 0}, Random(2));
  const GroupIndex g = planner.add_group({120, 100}, {300, 100}, 8);
  const FrozenTrees<2> single{
      .radius = 8, .nodes = {{160, 30}, {260, 30}, {160, 70}, {260, 70}}, .parents = {-1, -1, -1, -1}};
  const NodeId first = planner.add_inactive_trees(single);
  planner.add_link(first, first + 1);
  EXPECT_FALSE(planner.solved(g));
  planner.add_link(first + 2, first + 3);
  ASSERT_TRUE(planner.solved(g));
  expect_valid_path(planner.path(g), {120, 100}, {300, 100}, 8, field);
}

TEST(MaRrdtStar, CostsInRootTreesAreSumsOfEdgeLengths) {
  const ClearanceField field(two_rooms());
  Planner planner(field, {.epsilon = 15, .disjointed_trees = 0}, Random(4));
  const GroupIndex g = planner.add_group({20, 20}, {380, 20}, 8);
  run(planner, 3000);
  const auto& trees = planner.trees();
  int checked = 0;
  for (const NodeId n : planner.take_root_nodes(g)) {
    const NodeId parent = trees.parent(n);
    if (parent == no_node) continue;
    EXPECT_EQ(trees.tree_of(parent), trees.tree_of(n));
    EXPECT_NEAR(trees.cost(n), trees.cost(parent) + (trees.position(n) - trees.position(parent)).norm(),
                1e-9);
    EXPECT_TRUE(field.segment_free(trees.position(parent), trees.position(n), 8));
    ++checked;
  }
  EXPECT_GT(checked, 10);
}

/// Boxes in space: the 3-D counterpart of a map, for a planner that does not assume a plane.
struct BoxWorld {
  static constexpr int dimension = 3;
  Box<3> box{{0, 0, 0}, {100, 100, 100}};
  std::vector<Box<3>> obstacles;

  Box<3> bounds() const { return box; }
  bool is_free(const Point<3>& p, double radius) const {
    if (((p.array() - radius) < box.lower.array()).any() ||
        ((p.array() + radius) > box.upper.array()).any()) {
      return false;
    }
    for (const Box<3>& o : obstacles) {
      if ((p - p.cwiseMax(o.lower).cwiseMin(o.upper)).norm() < radius) return false;
    }
    return true;
  }
  bool segment_free(const Point<3>& a, const Point<3>& b, double radius) const {
    const int steps = std::max(1, static_cast<int>((b - a).norm() / 0.25));
    for (int i = 0; i <= steps; ++i) {
      if (!is_free(a + (b - a) * (static_cast<double>(i) / steps), radius)) return false;
    }
    return true;
  }
};

TEST(MaRrdtStar, ThePlannerPlansInThreeDimensions) {
  // Two walls, each with a window at another corner.
  BoxWorld world;
  world.obstacles = {{{30, 0, 0}, {35, 100, 75}},
                     {{30, 0, 75}, {35, 75, 100}},
                     {{65, 0, 25}, {70, 100, 100}},
                     {{65, 25, 0}, {70, 100, 25}}};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    MaRrdtStar<BoxWorld> planner(world, {.epsilon = 15, .disjointed_trees = 16}, Random(seed));
    const GroupIndex a = planner.add_group({10, 10, 10}, {90, 90, 90}, 3);
    const GroupIndex b = planner.add_group({10, 90, 10}, {90, 10, 90}, 3);
    for (int i = 0; i < 400'000 && planner.step(); ++i) {
    }
    for (const GroupIndex g : {a, b}) {
      ASSERT_TRUE(planner.solved(g)) << "seed " << seed;
      const auto path = planner.path(g);
      ASSERT_GE(path.size(), 2u);
      for (std::size_t i = 1; i < path.size(); ++i) EXPECT_TRUE(world.segment_free(path[i - 1], path[i], 3));
    }
  }
}

TEST(MaRrdtStar, GroupsWhoseRadiiHardlyDifferShareTheirTrees) {
  const ClearanceField field(two_rooms());
  Planner planner(field, {.epsilon = 40, .disjointed_trees = 16}, Random(1));
  for (const double radius : {5.0, 5.0002, 8.0}) planner.add_remote_group(radius);
  for (int i = 0; i < 2'000; ++i) planner.step();
  std::set<double> radii;
  for (TreeIndex t = 0; t < planner.trees().tree_count(); ++t) {
    if (planner.trees().is_tree(t) && planner.trees().tree(t).kind != TreeKind::root)
      radii.insert(planner.trees().tree(t).radius);
  }
  EXPECT_EQ(radii, (std::set<double>{5.0002, 8.0}));
}

}  // namespace
}  // namespace coppice
