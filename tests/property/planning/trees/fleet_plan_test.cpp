// Tests of fleet plans on maps of the four kinds: every robot finds its path, and the trees keep their
// clearance.

#include "planning/trees/fleet_plan.h"

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "planning/trees/suggestions.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::radius;

class FleetPlanOnMaps : public testing::TestWithParam<MapKind> {};

TEST_P(FleetPlanOnMaps, TenRobotsHaveAPathIn20Seeds) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const ClearanceField field(generate_map(GetParam(), 512, 512, random));
    std::vector<PlanningProblem> problems;
    for (const auto& [start, goal] : random_tasks(field, 10, radius, 0.4, random))
      problems.push_back({start, goal, radius});
    FleetPlanner planner(field, problems, {}, Random(seed));
    while (planner.search()) {
    }
    planner.take_first_paths();
    double first = 0;
    for (std::size_t i = 0; i < problems.size(); ++i) first += length_of(planner.path(i));
    while (planner.improve()) {
    }
    double sum = 0;
    for (std::size_t i = 0; i < problems.size(); ++i) {
      const Path path = planner.path(i);
      ASSERT_GE(path.size(), 2u) << "seed " << seed << " robot " << i << ": " << planner.reason(i);
      sum += length_of(path);
      EXPECT_EQ(path.front(), problems[i].start);
      EXPECT_EQ(path.back(), problems[i].goal);
      for (std::size_t k = 1; k < path.size(); ++k)
        EXPECT_TRUE(field.segment_free(path[k - 1], path[k], radius));
    }
    EXPECT_LE(sum, first * (1 + 1e-12));
  }
}

// A goal may lie in a pocket that no earlier robot needed.
TEST_P(FleetPlanOnMaps, TheTreesOfTheFirstTasksServeTheSecond) {
  int with_few_new_nodes = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const ClearanceField field(generate_map(GetParam(), 512, 512, random));
    const auto drawn = [&] {
      std::vector<PlanningProblem> problems;
      for (const auto& [start, goal] : random_tasks(field, 10, radius, 0.2, random))
        problems.push_back({start, goal, radius});
      return problems;
    };
    const auto plan = [](FleetPlanner& planner) {
      while (planner.search()) {
      }
      planner.take_first_paths();
    };
    FleetPlanner planner(field, drawn(), {}, Random(seed));
    plan(planner);
    const auto nodes = planner.disjointed_counts().valid;
    const std::vector<PlanningProblem> second = drawn();
    planner.begin_mission(second);
    plan(planner);
    with_few_new_nodes += planner.disjointed_counts().valid - nodes <= nodes / 2;
    for (std::size_t i = 0; i < second.size(); ++i) {
      const Path path = planner.path(i);
      ASSERT_GE(path.size(), 2u) << "seed " << seed << " robot " << i << ": " << planner.reason(i);
      EXPECT_EQ(path.front(), second[i].start);
      EXPECT_EQ(path.back(), second[i].goal);
      for (std::size_t k = 1; k < path.size(); ++k)
        EXPECT_TRUE(field.segment_free(path[k - 1], path[k], radius));
    }
  }
  EXPECT_GE(with_few_new_nodes, 6) << "of 10 seeds";
}

TEST_P(FleetPlanOnMaps, EveryRobotHasAPathWithThePlainParametersOfThePaper) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Random random(seed);
    const ClearanceField field(generate_map(GetParam(), 256, 256, random));
    std::vector<PlanningProblem> problems;
    for (const auto& [start, goal] : random_tasks(field, 5, radius, 0.4, random))
      problems.push_back({start, goal, radius});
    FleetPlanner planner(field, problems, plain_parameters(5), Random(seed));
    while (planner.search()) {
    }
    planner.take_first_paths();
    for (std::size_t i = 0; i < problems.size(); ++i)
      EXPECT_GE(planner.path(i).size(), 2u) << "seed " << seed << " robot " << i << ": " << planner.reason(i);
  }
}

TEST_P(FleetPlanOnMaps, EveryEdgeOfEveryTreeKeepsItsClearance) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    const ClearanceField field(generate_map(GetParam(), 256, 256, random));
    MaRrdtStar<ClearanceField> planner(
        field, {.epsilon = suggested_epsilon(field, radius), .disjointed_trees = 16}, Random(seed));
    for (const auto& [start, goal] : random_tasks(field, 5, radius, 0.4, random))
      planner.add_group(start, goal, radius);
    while (planner.step()) {
    }
    const Trees<2>& trees = planner.trees();
    for (NodeId n = 0; n < trees.node_count(); ++n) {
      trees.for_each_edge(n, [&](const auto& edge) {
        EXPECT_TRUE(field.segment_free(trees.position(n), trees.position(edge.to), radius))
            << "seed " << seed;
      });
    }
  }
}

std::string name_of(const testing::TestParamInfo<MapKind>& kind) {
  const std::vector<std::string> names{"blank", "dense", "maze", "room"};
  return names[static_cast<std::size_t>(kind.param)];
}

INSTANTIATE_TEST_SUITE_P(Maps, FleetPlanOnMaps,
                         testing::Values(MapKind::blank, MapKind::dense, MapKind::maze, MapKind::room),
                         name_of);

TEST(FleetPlan, AnUnreachableGoalEndsWithAReason) {
  OccupancyMap map;
  map.width = 100;
  map.height = 40;
  map.blocked.assign(4000, 0);
  for (int j = 0; j < 40; ++j) map.blocked[static_cast<std::size_t>(j * 100 + 50)] = 1;
  const ClearanceField field(map);
  const std::vector<PlanningProblem> problems{{{20, 20}, {80, 20}, 5}, {{10, 10}, {10, 30}, 5}};
  FleetPlanner planner(field, problems, {}, Random(1));
  while (planner.search()) {
  }
  planner.take_first_paths();
  while (planner.improve()) {
  }
  EXPECT_TRUE(planner.path(0).empty());
  EXPECT_NE(planner.reason(0).find("cannot be reached"), std::string::npos);
  EXPECT_FALSE(planner.path(1).empty());
}

}  // namespace
}  // namespace coppice
