// Tests of what must hold for all trees at any time, on random maps with random tasks and robots of several
// radii.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "coppice/planning/map_generator.h"
#include "planning/trees/ma_rrdt_star.h"
#include "planning/trees/path_improvement.h"
#include "planning/trees/rrt_star.h"
#include "planning/trees/suggestions.h"

namespace coppice {
namespace {

using Planner = MaRrdtStar<ClearanceField>;

/// A planner on a random map, some way into its search.
struct Setting {
  explicit Setting(std::uint64_t seed)
      : random(seed),
        field(generate_map(static_cast<MapKind>(random.index(4)), 128 + static_cast<int>(random.index(128)),
                           128 + static_cast<int>(random.index(128)), random)),
        planner(field,
                {.epsilon = suggested_epsilon(field, 3) * random.uniform(0.3, 1.5),
                 .disjointed_trees = 4 + static_cast<std::uint32_t>(random.index(20))},
                Random(seed)) {
    const double largest = random.uniform(2, 6);
    for (const StartAndGoal& task :
         random_tasks(field, 1 + static_cast<int>(random.index(6)), largest, 0, random)) {
      const double radius = random.uniform() < 0.5 ? largest : random.uniform(1, largest);
      tasks.push_back({task.start, task.goal, radius});
      planner.add_group(task.start, task.goal, radius);
    }
  }
  struct Task {
    Point2 start;
    Point2 goal;
    double radius;
  };
  Random random;
  ClearanceField field;
  Planner planner;
  std::vector<Task> tasks;
};

void check_edges(const Trees<2>& trees, const ClearanceField& field) {
  for (NodeId n = 0; n < trees.node_count(); ++n) {
    const double own = trees.tree(trees.tree_of(n)).radius;
    RC_ASSERT(field.is_free(trees.position(n), own));
    trees.for_each_edge(n, [&](const auto& edge) {
      const double radius = std::min(own, trees.tree(trees.tree_of(edge.to)).radius);
      RC_ASSERT(field.segment_free(trees.position(n), trees.position(edge.to), radius));
    });
  }
}

/// Checks that costs-to-come are sums of the edges back to the root, and that a path to the root exists.
void check_costs(const Trees<2>& trees, TreeIndex root_tree) {
  trees.for_each_node(root_tree, [&](NodeId n) {
    double sum = 0;
    std::size_t steps = 0;
    for (NodeId k = n; trees.parent(k) != no_node; k = trees.parent(k)) {
      sum += (trees.position(k) - trees.position(trees.parent(k))).norm();
      RC_ASSERT(++steps <= trees.node_count());
    }
    RC_ASSERT(std::abs(sum - trees.cost(n)) <= 1e-9 * (1 + sum));
  });
}

RC_GTEST_PROP(Trees, TreesHoldTheirInvariantsAtAnyTime, (std::uint64_t seed)) {
  Setting s(seed);
  for (int round = 0; round < 6; ++round) {
    for (std::size_t k = s.random.index(400); k > 0 && s.planner.step(); --k) {
    }
    check_edges(s.planner.trees(), s.field);
    for (GroupIndex g = 0; g < s.tasks.size(); ++g) {
      check_costs(s.planner.trees(), s.planner.root_tree(g, Root::start));
      check_costs(s.planner.trees(), s.planner.root_tree(g, Root::goal));
      if (!s.planner.is_open(g)) continue;
      // No tree is grafted to both root trees of an unsolved group.
      const Trees<2>& trees = s.planner.trees();
      for (TreeIndex t = 0; t < trees.tree_count(); ++t) {
        if (!trees.is_tree(t) || trees.tree(t).kind != TreeKind::inactive) continue;
        RC_ASSERT(!(s.planner.has_grafted(g, Root::start, t) && s.planner.has_grafted(g, Root::goal, t)));
      }
    }
  }
}

RC_GTEST_PROP(Trees, ASolvedGroupGrowsNoFurther, (std::uint64_t seed)) {
  Setting s(seed);
  std::vector<std::optional<std::uint32_t>> size(s.tasks.size());
  bool going = true;
  for (int round = 0; round < 200 && going; ++round) {
    for (int k = 0; k < 50 && going; ++k) going = s.planner.step();
    for (GroupIndex g = 0; g < s.tasks.size(); ++g) {
      const Trees<2>& trees = s.planner.trees();
      const std::uint32_t nodes = trees.tree(s.planner.root_tree(g, Root::start)).size +
                                  trees.tree(s.planner.root_tree(g, Root::goal)).size;
      if (size[g]) RC_ASSERT(*size[g] == nodes);
      if (s.planner.solved(g)) size[g] = nodes;
    }
  }
}

/// Both forms of extraction, then the improved path: from start to goal, free, and never longer than before.
RC_GTEST_PROP(Trees, PathsAreFreeAndOnlyBecomeShorter, (std::uint64_t seed)) {
  Setting s(seed);
  for (int k = 0; k < 30'000 && s.planner.step(); ++k) {
  }
  PathImprover<ClearanceField> improver(s.field, suggested_epsilon(s.field, 3), Random(seed));
  const auto check = [&](const Path& path, const Setting::Task& task) {
    RC_ASSERT(path.size() >= 2);
    RC_ASSERT(path.front() == task.start);
    RC_ASSERT(path.back() == task.goal);
    for (std::size_t i = 1; i < path.size(); ++i)
      RC_ASSERT(s.field.segment_free(path[i - 1], path[i], task.radius));
  };
  const std::vector<Path> together = s.planner.paths();
  std::vector<std::size_t> solved;
  for (GroupIndex g = 0; g < s.tasks.size(); ++g) {
    RC_ASSERT(together[g].empty() == !s.planner.solved(g));
    if (!s.planner.solved(g)) continue;
    check(together[g], s.tasks[g]);
    const Path alone = s.planner.path(g);
    check(alone, s.tasks[g]);
    improver.add_robot(alone, s.tasks[g].radius);
    solved.push_back(g);
  }
  improver.add_places(s.planner.trees());
  std::vector<double> before(solved.size(), 1e300);
  for (int k = 0; k < 300 && !solved.empty() && improver.step(); ++k) {
    for (std::size_t i = 0; i < solved.size(); ++i) {
      RC_ASSERT(length_of(improver.path(i)) <= before[i] * (1 + 1e-12));
      before[i] = length_of(improver.path(i));
    }
  }
  for (std::size_t i = 0; i < solved.size(); ++i) check(improver.path(i), s.tasks[solved[i]]);
}

RC_GTEST_PROP(RrtStar, PathsAreFreeAndNoLongerThanTheTreeSays, (std::uint64_t seed)) {
  Setting s(seed);
  const Setting::Task& task = s.tasks.front();
  RrtStar<ClearanceField> planner(s.field, task.start, task.goal, task.radius, suggested_epsilon(s.field, 3),
                                  Random(seed));
  for (int k = 0; k < 5000 && planner.step(); ++k) {
  }
  const Path path = planner.path();
  RC_ASSERT(path.empty() == !planner.solved());
  if (path.empty()) return;
  RC_ASSERT(path.front() == task.start);
  RC_ASSERT(path.back() == task.goal);
  for (std::size_t i = 1; i < path.size(); ++i)
    RC_ASSERT(s.field.segment_free(path[i - 1], path[i], task.radius));
}

}  // namespace
}  // namespace coppice
