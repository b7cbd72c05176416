// Tests of the public function that plans trajectories for a fleet.

#include "coppice/motion/plan_trajectories.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::limits;

std::vector<DrivingTask> tasks_on(const ClearanceField& field, int robots, double radius, Random& random) {
  std::vector<DrivingTask> tasks;
  for (const StartAndGoal& task : random_tasks(field, robots, radius, 0.2, random))
    tasks.push_back({task.start, task.goal, radius, limits});
  return tasks;
}

TEST(PlanTrajectories, RobotsReachTheirGoalsTouchNothingAndKeepTheirSpeed) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const ClearanceField field(
        generate_map(seed % 2 == 0 ? MapKind::room : MapKind::dense, 256, 256, random));
    std::vector<DrivingTask> tasks = tasks_on(field, 12, 5, random);
    for (std::size_t k = 0; k < tasks.size(); k += 3) tasks[k].radius = 3;
    const FleetTrajectories fleet = plan_trajectories(field, tasks, seed);
    EXPECT_TRUE(fleet.stranded.empty()) << seed;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const Trajectory& own = fleet.trajectories[i];
      EXPECT_EQ(own.front().position, tasks[i].start);
      EXPECT_EQ(own.front().time, 0);
      EXPECT_EQ(own.back().position, tasks[i].goal);
      for (std::size_t k = 1; k < own.size(); ++k) {
        const double length = (own[k].position - own[k - 1].position).norm();
        EXPECT_LE(length, limits.max_speed * (own[k].time - own[k - 1].time) + 1e-6);
        EXPECT_TRUE(field.segment_free(own[k - 1].position, own[k].position, tasks[i].radius));
      }
      for (std::size_t j = 0; j < i; ++j) {
        const double touching = tasks[i].radius + tasks[j].radius - 1e-6;
        EXPECT_FALSE(come_too_close(own, fleet.trajectories[j], touching, 0))
            << seed << ": " << i << ", " << j;
      }
    }
  }
}

TEST(PlanTrajectories, AStopEndsTheImprovementButLeavesNobodyWithoutATrajectory) {
  Random random(3);
  const ClearanceField field(generate_map(MapKind::room, 256, 256, random));
  const std::vector<DrivingTask> tasks = tasks_on(field, 10, 5, random);
  const FleetTrajectories early = plan_trajectories(field, tasks, 1, [] { return true; });
  const FleetTrajectories late = plan_trajectories(field, tasks, 1);
  double sum_early = 0;
  double sum_late = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    EXPECT_EQ(early.trajectories[i].back().position, tasks[i].goal);
    sum_early += early.trajectories[i].back().time;
    sum_late += late.trajectories[i].back().time;
  }
  EXPECT_LT(sum_late, sum_early);
}

TEST(PlanTrajectories, ARobotThatCannotReachItsGoalIsStranded) {
  OccupancyMap map{.width = 40, .height = 20, .blocked = std::vector<std::uint8_t>(800, 0)};
  for (std::size_t j = 0; j < 20; ++j) map.blocked[40 * j + 20] = 1;
  const ClearanceField field(map);
  const std::vector<DrivingTask> tasks{{{5, 5}, {35, 5}, 2, limits}, {{5, 15}, {12, 15}, 2, limits}};
  const FleetTrajectories fleet = plan_trajectories(field, tasks);
  EXPECT_EQ(fleet.stranded, std::vector<std::size_t>{0});
  EXPECT_EQ(fleet.trajectories[1].back().position, tasks[1].goal);
  EXPECT_TRUE(plan_trajectories(field, {}).trajectories.empty());
}

TEST(PlanTrajectories, FaultsOfATaskNameItsMember) {
  const ClearanceField field({.width = 40, .height = 20, .blocked = std::vector<std::uint8_t>(800, 0)});
  const auto error = [&](auto&& spoil) -> std::string {
    std::vector<DrivingTask> tasks{{{5, 5}, {35, 5}, 2, limits}, {{5, 15}, {35, 15}, 2, limits}};
    spoil(tasks[1]);
    try {
      plan_trajectories(field, tasks);
      return "no error";
    } catch (const std::invalid_argument& problem) {
      return problem.what();
    }
  };
  EXPECT_TRUE(error([](auto& task) { task.start = {1, 1}; }).starts_with("tasks[1].start: (1, 1) is inside"));
  EXPECT_TRUE(error([](auto& task) { task.start = {5, 7}; }).starts_with("tasks[1].start: overlaps"));
  EXPECT_TRUE(error([](auto& task) { task.goal = {35, 7}; }).starts_with("tasks[1].goal: overlaps"));
  EXPECT_TRUE(error([](auto& task) { task.radius = -1; }).starts_with("tasks[1].radius: -1"));
  EXPECT_TRUE(error([](auto& task) { task.limits.max_speed = 0; }).starts_with("tasks[1].limits"));
  EXPECT_TRUE(error([](auto& task) { task.limits.max_acceleration = 1e-3; }).starts_with("tasks[1].limits"));
  EXPECT_EQ(error([](auto&) {}), "no error");
}

}  // namespace
}  // namespace coppice
