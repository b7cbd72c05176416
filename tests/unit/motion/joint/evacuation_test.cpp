#include "motion/joint/evacuation.h"

#include <optional>

#include <gtest/gtest.h>

#include "motion/joint/cluster_roadmap.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

using test::block;
using test::driven;
using test::hall_and_aisle;
using test::open_map;

std::optional<JointPlan> evacuated(const OccupancyMap& map, const std::vector<JointTask>& tasks) {
  const ClearanceField field(map);
  MapRoadmaps roadmaps(field);
  ClusterRoadmap roadmap(roadmaps, tasks, {}, {});
  Evacuation evacuation(roadmap.cluster(), Random(1));
  SearchState progress = SearchState::searching;
  while (progress == SearchState::searching) progress = evacuation.step();
  return progress == SearchState::solved ? std::optional(roadmap.plan_of(evacuation.moves())) : std::nullopt;
}

void expect_solved(const OccupancyMap& map, const std::vector<JointTask>& tasks) {
  const auto plan = evacuated(map, tasks);
  ASSERT_TRUE(plan);
  EXPECT_TRUE(plan->stranded.empty());
  const std::vector<Point2> ends = driven(map, tasks, *plan);
  for (std::size_t i = 0; i < tasks.size(); ++i) EXPECT_EQ(ends[i], tasks[i].goal.value_or(ends[i])) << i;
}

// The robot that stands nearest to the exit must go in deepest.
TEST(Evacuation, ADeadEndFilledInTheWrongOrderIsFilledAgain) {
  for (const int robots : {2, 6, 12}) {
    std::vector<JointTask> tasks;
    for (int k = 0; k < robots; ++k) tasks.push_back({{120.0 + 11 * k, 50}, Point2(280 - 11 * k, 50), 5});
    expect_solved(hall_and_aisle(), tasks);
  }
}

TEST(Evacuation, ARobotAtItsGoalComesOutAndReturns) {
  const std::vector<JointTask> tasks{
      {{50, 50}, Point2(280, 50), 5}, {{200, 50}, Point2(200, 50), 5}, {{230, 50}, std::nullopt, 5}};
  expect_solved(hall_and_aisle(), tasks);
}

TEST(Evacuation, RobotsOfSeveralSizesAreReassembled) {
  std::vector<JointTask> tasks;
  for (int k = 0; k < 6; ++k) tasks.push_back({{120.0 + 13 * k, 50}, Point2(280 - 13 * k, 50), 3 + 0.5 * k});
  expect_solved(hall_and_aisle(), tasks);
}

// No vertex is so wide that others can drive around it, so that robots park in the ends of branches.
TEST(Evacuation, RobotsParkInBranchesOfCorridors) {
  OccupancyMap map = open_map(200, 200);
  block(map, 0, 0, 200, 200);
  block(map, 10, 93, 190, 107, false);
  block(map, 93, 10, 107, 93, false);
  expect_solved(map, {{{30, 100}, Point2(170, 100), 5}, {{170, 100}, Point2(30, 100), 5}});
}

TEST(Evacuation, ThereIsNoPlanWithoutAVertexToParkOn) {
  OccupancyMap map = open_map(200, 40);
  block(map, 0, 0, 200, 40);
  block(map, 10, 13, 190, 27, false);
  EXPECT_FALSE(evacuated(map, {{{30, 20}, Point2(170, 20), 5}, {{170, 20}, Point2(30, 20), 5}}));
}

TEST(Evacuation, ARobotWithoutAPathIsStrandedAndTheOthersArrive) {
  const std::vector<JointTask> tasks{
      {{60, 20}, Point2(280, 50), 5}, {{150, 50}, Point2(20, 80), 5}, {{230, 50}, std::nullopt, 5, false}};
  const auto plan = evacuated(hall_and_aisle(), tasks);
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->stranded, std::vector<std::size_t>{0});
  EXPECT_EQ(driven(hall_and_aisle(), tasks, *plan)[1], Point2(20, 80));
}

}  // namespace
}  // namespace coppice
