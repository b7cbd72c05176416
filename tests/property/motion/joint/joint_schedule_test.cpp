// Tests of the times of joint plans: robots that carry them out keep apart, whatever their speed.
#include "motion/joint/joint_schedule.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "motion/body/way_follower.h"
#include "motion/joint/joint_planner.h"
#include "motion/trajectory/corner_speed.h"
#include "motion/trajectory/reserved_order.h"
#include "tests/unit/motion/plans.h"
#include "tests/unit/motion/trajectories.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::position_at;

using test::radius;
constexpr double period = 0.05;
using test::limits;

double latest(const std::vector<Trajectory>& trajectories) {
  double end = 0;
  for (const Trajectory& trajectory : trajectories) end = std::max(end, trajectory.back().time);
  return end;
}

/// The least distance between the centres of two robots that carry out the trajectories.
double nearest(const std::vector<Trajectory>& trajectories) {
  double least = 1e9;
  for (double time = 0; time < latest(trajectories); time += 0.05) {
    for (std::size_t a = 0; a < trajectories.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b)
        least =
            std::min(least, (position_at(trajectories[a], time) - position_at(trajectories[b], time)).norm());
    }
  }
  return least;
}

std::vector<Trajectory> complete(JointSchedule schedule) {
  while (!schedule.step()) {
  }
  return schedule.trajectories();
}

std::vector<JointSchedule::Robot> robots_of(const std::vector<JointTask>& tasks) {
  std::vector<JointSchedule::Robot> robots;
  for (const JointTask& task : tasks) robots.push_back({task.position, radius, limits});
  return robots;
}

/// Tasks of robots in random rooms, and the trajectories of a joint plan for them.
struct Rooms {
  explicit Rooms(std::uint64_t seed) : random(seed) {
    for (const StartAndGoal& task : random_tasks(field, 8, 1.1 * radius, 0.2, random))
      tasks.push_back({task.start, task.goal, 1.1 * radius});
    plan = joint_plan(roadmaps, tasks, Random(seed));
    trajectories = complete({roadmaps, robots_of(tasks), plan.moves, {}, {}, 1, period});
  }
  Random random;
  OccupancyMap map = generate_map(MapKind::room, 256, 256, random);
  ClearanceField field{map};
  MapRoadmaps roadmaps{field};
  std::vector<JointTask> tasks;
  JointPlan plan;
  std::vector<Trajectory> trajectories;
};

TEST(JointSchedule, TrajectoriesKeepApartAndEndAtTheGoals) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const Rooms rooms(seed);
    ASSERT_TRUE(rooms.plan.stranded.empty());
    EXPECT_GE(nearest(rooms.trajectories), kept_apart(radius, radius) - 1e-6);
    for (std::size_t i = 0; i < rooms.tasks.size(); ++i) {
      const Trajectory& trajectory = rooms.trajectories[i];
      EXPECT_EQ(trajectory.front().position, rooms.tasks[i].position);
      EXPECT_EQ(trajectory.back().position, *rooms.tasks[i].goal);
      EXPECT_TRUE(std::ranges::is_sorted(trajectory, {}, &TimedPoint::time));
      for (std::size_t k = 1; k < trajectory.size(); ++k)
        EXPECT_TRUE(
            rooms.field.segment_free(trajectory[k - 1].position, trajectory[k].position, radius - 1e-9));
    }
  }
}

TEST(JointSchedule, RobotsKeepTheOrderAtAnySpeed) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Rooms rooms(seed);
    const std::vector<Trajectory>& trajectories = rooms.trajectories;
    struct Runner {
      WayFollower follower;
      std::vector<Gates> gates;  ///< by other robot
      Point2 position;
      double pace;
      int pause = 0;
    };
    std::vector<Runner> runners;
    for (const Trajectory& own : trajectories) {
      std::vector<Gates> gates;
      for (const Trajectory& other : trajectories)
        gates.emplace_back(&other == &own ? std::vector<Gate>()
                                          : order_of(own, radius, other, radius, 0).gates);
      runners.push_back({WayFollower(legs_of(path_of(own)), radius, reserved_stray_radii * radius),
                         std::move(gates), own.front().position, rooms.random.uniform(2, 20)});
    }
    bool all_there = false;
    for (int step = 0; step < 40'000 && !all_there; ++step) {
      all_there = true;
      for (Runner& runner : runners) {
        if (runner.follower.finished()) continue;
        all_there = false;
        if (runner.pause == 0 && rooms.random.uniform() < 0.002) runner.pause = 200;
        if (runner.pause > 0 && --runner.pause > 0) continue;
        double open = 1e9;
        for (std::size_t k = 0; k < runners.size(); ++k)
          open = std::min(open, runner.gates[k].open(runner.follower.progress(), gate_slack_radii * radius,
                                                     runners[k].follower.progress()));
        runner.follower.come_to(runner.position);
        runner.position += period * runner.follower.preferred_velocity(
                                        runner.position, {runner.pace, 2 * runner.pace}, period, open);
      }
      for (std::size_t a = 0; a < runners.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b)
          ASSERT_GE((runners[a].position - runners[b].position).norm(), 2 * radius)
              << "step " << step << ": " << a << " and " << b;
      }
    }
    EXPECT_TRUE(all_there);
    for (std::size_t i = 0; i < runners.size(); ++i)
      EXPECT_LT((runners[i].position - *rooms.tasks[i].goal).norm(), 0.1);
  }
}

TEST(JointSchedule, RobotsThatMeetNobodySetOffAtOnce) {
  const ClearanceField field(test::open_map(200, 200));
  MapRoadmaps roadmaps(field);
  const auto trajectories = complete({roadmaps,
                                      {{{20, 20}, radius, limits}, {{20, 100}, radius, limits}},
                                      {{0, {{20, 20}, {180, 20}}}, {1, {{20, 100}, {180, 100}}}},
                                      {},
                                      {},
                                      3,
                                      period});
  for (const Trajectory& trajectory : trajectories) {
    EXPECT_EQ(trajectory.front().time, 3);
    EXPECT_NEAR(trajectory.back().time, 3 + 8, 1e-9);
  }
}

TEST(JointSchedule, RobotsHaveTimeForEachCorner) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const Rooms rooms(seed);
    for (const Trajectory& trajectory : rooms.trajectories) {
      const Path path = path_of(trajectory);
      double least = length_of(path) / limits.max_speed;
      for (std::size_t k = 1; k + 1 < path.size(); ++k)
        least += time_lost_around((path[k] - path[k - 1]).normalized(), (path[k + 1] - path[k]).normalized(),
                                  reserved_stray_radii * radius, limits);
      EXPECT_GE(trajectory.back().time - trajectory.front().time, least - 1e-6);
    }
  }
}

// Robot 1 waits aside in the plan. A straight way past robot 0 is shorter.
TEST(JointSchedule, ANeedlessDetourIsLeftOut) {
  const ClearanceField field(test::open_map(200, 200));
  MapRoadmaps roadmaps(field);
  const std::vector<Move> moves{
      {1, {{180, 100}, {180, 180}}}, {0, {{20, 100}, {180, 100}}}, {1, {{180, 180}, {20, 180}, {20, 100}}}};
  const auto trajectories = complete(
      {roadmaps, {{{20, 100}, radius, limits}, {{180, 100}, radius, limits}}, moves, {}, {}, 0, period});
  EXPECT_LT(trajectories[1].back().time, 10);
  EXPECT_GE(nearest(trajectories), kept_apart(radius, radius) - 1e-6);
}

// The other one comes from the right, and ends beside the way.
TEST(JointSchedule, RobotsKeepApartFromThoseThatAreNotOfThePlan) {
  const ClearanceField field(test::open_map(200, 200));
  MapRoadmaps roadmaps(field);
  const JointSchedule::Other other{{{0, {100, 20}}, {4, {100, 100}}, {6, {100, 100}}, {10, {100, 180}}},
                                   radius};
  auto trajectories = complete(
      {roadmaps, {{{20, 100}, radius, limits}}, {{0, {{20, 100}, {180, 100}}}}, {other}, {}, 0, period});
  EXPECT_GT(trajectories[0].back().time, 8);
  trajectories.push_back(other.trajectory);
  EXPECT_GE(nearest(trajectories), kept_apart(radius, radius) - 1e-6);
}

// The first robot ends on the way, the second one crosses it later, and the third one passes the start.
TEST(JointSchedule, ThoseThatAreInTheWayForGoodMustGiveWay) {
  const ClearanceField field(test::open_map(200, 200));
  MapRoadmaps roadmaps(field);
  const JointSchedule::Other ends{{{0, {100, 20}}, {4, {100, 100}}}, radius};
  const JointSchedule::Other crosses{{{0, {150, 20}}, {10, {150, 20}}, {14, {150, 100}}, {18, {150, 180}}},
                                     radius};
  const JointSchedule::Other runs_over{{{0, {20, 20}}, {2, {20, 100}}, {4, {20, 180}}}, radius};
  JointSchedule schedule(roadmaps, {{{20, 100}, radius, limits}}, {{0, {{20, 100}, {180, 100}}}},
                         {ends, crosses, runs_over}, {}, 0, period);
  while (!schedule.step()) {
  }
  EXPECT_EQ(schedule.trajectories()[0].back().position, Point2(180, 100));
  const std::vector<std::size_t> passed = schedule.passed();
  EXPECT_EQ(std::ranges::count(passed, 0u), 0);
  EXPECT_EQ(std::ranges::count(passed, 1u), 1);
  for (const std::size_t k : passed) {
    const JointSchedule::Other& other = k == 1 ? crosses : runs_over;
    EXPECT_FALSE(come_too_close(schedule.trajectories()[0], other.trajectory, 2 * radius - 1e-6, 0));
  }
}

// In a corridor for one, robot 0 waits at its start behind the slow robot 1. Meanwhile another one was to
// come there, and to return.
TEST(JointSchedule, ThoseThatPassWhereARobotWaitsMustGiveWay) {
  const ClearanceField field(test::open_map(220, 14));
  MapRoadmaps roadmaps(field);
  const JointSchedule::Other comes{{{0, {10, 7}}, {2, {40, 7}}, {4, {10, 7}}}, radius};
  const JointSchedule::Other stays_away{{{0, {6, 7}}, {2, {20, 7}}, {4, {6, 7}}}, radius};
  const std::vector<Move> moves{{1, {{60, 7}, {210, 7}}}, {0, {{40, 7}, {180, 7}}}};
  JointSchedule schedule(roadmaps, {{{40, 7}, radius, limits}, {{60, 7}, radius, {1, 2}}}, moves,
                         {comes, stays_away}, {}, 0, period);
  while (!schedule.step()) {
  }
  EXPECT_EQ(schedule.trajectories()[0].back().position, Point2(180, 7));
  EXPECT_EQ(schedule.passed(), std::vector<std::size_t>{1});
}

// Robots that almost touch cannot keep apart as usual.
TEST(JointSchedule, MovesPastRobotsThatAlmostTouchAreMadeAllTheSame) {
  const ClearanceField field(test::open_map(200, 200));
  MapRoadmaps roadmaps(field);
  const std::vector<Move> moves{{0, {{20, 100}, {180, 100}}}, {1, {{20, 110.01}, {180, 110.01}}}};
  const auto trajectories = complete(
      {roadmaps, {{{20, 100}, radius, limits}, {{20, 110.01}, radius, limits}}, moves, {}, {}, 0, period});
  EXPECT_EQ(trajectories[0].back().position, Point2(180, 100));
  EXPECT_EQ(trajectories[1].back().position, Point2(180, 110.01));
  EXPECT_GE(nearest(trajectories), 2 * radius);
}

}  // namespace
}  // namespace coppice
