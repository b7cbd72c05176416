// Tests of the public function that plans paths.

#include "coppice/planning/plan_paths.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "tests/ways.h"

namespace coppice {
namespace {

constexpr double radius = 4;

/// Robots in random rooms.
struct Rooms {
  explicit Rooms(std::uint64_t seed) : random(seed) {
    for (const StartAndGoal& task : random_tasks(field, 6, radius, 0.3, random))
      problems.push_back({task.start, task.goal, radius});
  }
  Random random;
  ClearanceField field{generate_map(MapKind::room, 256, 256, random)};
  std::vector<PlanningProblem> problems{};
};

TEST(PlanPaths, EachPlannerFindsFreePathsAndTheSameOnesAgain) {
  const Rooms rooms(1);
  for (const PlannerKind planner :
       {PlannerKind::ma_rrdt_star, PlannerKind::rrdt_star, PlannerKind::rrt_star}) {
    const PathPlan plan = plan_paths(rooms.field, rooms.problems, {.planner = planner, .seed = 5});
    const PathPlan again = plan_paths(rooms.field, rooms.problems, {.planner = planner, .seed = 5});
    ASSERT_EQ(plan.robots.size(), rooms.problems.size());
    for (std::size_t i = 0; i < plan.robots.size(); ++i) {
      EXPECT_TRUE(test::is_way(plan.robots[i].path, rooms.problems[i], rooms.field)) << plan.robots[i].reason;
      EXPECT_EQ(plan.robots[i].path, again.robots[i].path);
    }
  }
}

TEST(PlanPaths, APlanThatIsStoppedSaysWhichRobotsHaveNoPath) {
  const Rooms rooms(2);
  const PathPlan plan =
      plan_paths(rooms.field, rooms.problems, {}, {.clock = {}, .stop = [] { return true; }});
  std::size_t without = 0;
  for (const PlannedPath& robot : plan.robots) {
    EXPECT_EQ(robot.path.empty(), !robot.reason.empty());
    without += robot.path.empty();
  }
  EXPECT_GT(without, 0u);
}

TEST(PlanPaths, TheClockEndsThePlan) {
  const Rooms rooms(3);
  double now = 100;
  const PathPlan plan = plan_paths(rooms.field, rooms.problems, {.timeout = 3},
                                   {.clock = [&] { return now += 1; }, .stop = {}});
  EXPECT_LT(now, 200) << "the clock was asked on and on";
  EXPECT_GT(plan.plan_time, 0);
}

TEST(PlanPaths, FaultsOfAProblemNameItsMember) {
  const Rooms rooms(4);
  const auto error = [&](auto&& spoil) -> std::string {
    std::vector<PlanningProblem> problems = rooms.problems;
    spoil(problems[2]);
    try {
      plan_paths(rooms.field, problems);
      return "no error";
    } catch (const std::invalid_argument& problem) {
      return problem.what();
    }
  };
  EXPECT_TRUE(error([](auto& p) { p.start = {-1, 3}; }).starts_with("problems[2].start: (-1, 3) is outside"));
  EXPECT_TRUE(error([](auto& p) { p.goal = {1, 1}; }).starts_with("problems[2].goal: (1, 1) is inside"));
  EXPECT_TRUE(error([](auto& p) { p.radius = 0; }).starts_with("problems[2].radius: 0 is not allowed"));
  EXPECT_TRUE(error([](auto& p) { p.radius = std::nan(""); }).starts_with("problems[2].radius: nan"));
  EXPECT_EQ(error([](auto&) {}), "no error");
}

}  // namespace
}  // namespace coppice
