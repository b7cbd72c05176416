#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "coppice/planning/map_generator.h"
#include "messages/validation.h"
#include "motion/joint/joint_planner.h"
#include "motion/trajectory/precedence.h"
#include "tests/support.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

using test::block;
using test::driven;
using test::hall_and_aisle;
using test::open_map;

/// A corridor of `width` along x through a blocked map, between two open halls.
OccupancyMap corridor(int width, int length = 160) {
  OccupancyMap map = open_map(length + 240, 120);
  block(map, 120, 0, 120 + length, 120);
  block(map, 120, 60 - width / 2, 120 + length, 60 - width / 2 + width, false);
  return map;
}

JointPlan solve(const OccupancyMap& map, const std::vector<JointTask>& tasks) {
  const ClearanceField field(map);
  MapRoadmaps roadmaps(field);
  JointPlan plan = joint_plan(roadmaps, tasks, Random(1));

  const std::vector<Point2> at = driven(map, tasks, plan);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const bool stranded = std::ranges::find(plan.stranded, i) != plan.stranded.end();
    EXPECT_EQ(stranded, at[i] != tasks[i].goal.value_or(at[i]));
  }
  testing::Test::RecordProperty("moves", std::to_string(plan.moves.size()));
  return plan;
}

/// The number of steps that a planner takes for a few robots in a deadlock on the rooms map, with many robots
/// elsewhere.
int steps_for_a_clinch(const std::vector<JointTask>& clinch) {
  Random random(4);
  const OccupancyMap map = generate_map(MapKind::room, 452, 452, random);
  const ClearanceField field(map);
  const auto far = [&](const Point2& p) {
    return std::ranges::all_of(clinch, [&](const JointTask& task) {
      return (p - task.position).norm() > 30 && (p - *task.goal).norm() > 12;
    });
  };
  std::vector<JointTask> tasks = clinch;
  for (const StartAndGoal& task : random_tasks(field, 60, 5, 0, random)) {
    if (far(task.start) && far(task.goal)) tasks.push_back({task.start, task.goal, 5});
  }
  MapRoadmaps roadmaps(field);
  JointPlanner planner(roadmaps, tasks, Random(1));
  int steps = 1;
  std::optional<JointPlan> plan;
  for (plan = planner.step(); !plan; plan = planner.step()) ++steps;
  EXPECT_TRUE(plan->stranded.empty());
  return steps;
}

// Neither robot has a straight path to a vertex that does not touch the other.
TEST(JointPlan, TwoRobotsSideBySideInADoorAreResolvedQuickly) {
  EXPECT_LT(steps_for_a_clinch({{{12.989584488505946, 132.49301147580744}, Point2(17.5, 131.5), 5},
                                {{22.99, 131.15}, Point2(21.5, 405.5), 5},
                                {{20, 116}, Point2(23.5, 121.5), 5}}),
            10);
}

// All paths to vertices further away pass too near to the next robot.
TEST(JointPlan, AColumnAlongAWallIsResolvedQuickly) {
  EXPECT_LT(steps_for_a_clinch({{{265.15224320524447, 240.93877724581463}, Point2(358.5, 366.5), 5},
                                {{262.97262513854434, 231.05468795430218}, Point2(129.5, 162.5), 5},
                                {{265.01492254613294, 250.97791153388519}, Point2(415.5, 342.5), 5}}),
            10);
}

TEST(JointPlan, ASingleRobotGetsOneMove) {
  const JointPlan plan = solve(open_map(100, 100), {{{10, 10}, Point2(90, 90), 5}});
  EXPECT_EQ(plan.moves.size(), 1u);
  EXPECT_TRUE(plan.stranded.empty());
  EXPECT_NEAR(length_of(plan.moves.front().path), std::hypot(80, 80), 2);
}

TEST(JointPlan, OneOfTwoRobotsHeadOnInACorridorGoesBack) {
  const JointPlan plan =
      solve(corridor(14), {{{180, 60}, Point2(320, 60), 5}, {{200, 60}, Point2(40, 60), 5}});
  EXPECT_TRUE(plan.stranded.empty());
  double driven = 0;
  for (const Move& move : plan.moves) driven += length_of(move.path);
  EXPECT_LT(driven, 140 + 160 + 200);  // one robot goes back by less than 100 m and comes again
}

TEST(JointPlan, APocketLetsOneRobotPass) {
  OccupancyMap map = open_map(200, 60);
  block(map, 0, 0, 200, 60);
  block(map, 0, 20, 200, 34, false);   // a corridor that is closed at both ends
  block(map, 90, 34, 110, 50, false);  // with a pocket
  const JointPlan plan = solve(map, {{{10, 27}, Point2(190, 27), 5}, {{190, 27}, Point2(10, 27), 5}});
  EXPECT_TRUE(plan.stranded.empty());
}

/// A corridor 14 m wide that is closed at its ends. It has pockets 16 m wide whose left walls are at
/// `pockets`.
OccupancyMap corridor_with_pockets(int length, std::initializer_list<int> pockets, int depth) {
  OccupancyMap map = open_map(length, 60);
  block(map, 0, 0, length, 60);
  block(map, 10, 10, length - 10, 24, false);
  for (const int x : pockets) block(map, x, 24, x + 16, 24 + depth, false);
  return map;
}

// In a pocket that is hardly deep enough, the packed vertex is in the way of the robot that passes.
TEST(JointPlan, APocketAtAnyPositionLetsOneRobotPass) {
  for (const int depth : {10, 11, 16}) {
    for (int x = 40; x <= 180; ++x) {
      const OccupancyMap map = corridor_with_pockets(240, {x}, depth);
      const JointPlan plan =
          solve(map, {{{114.94, 15}, Point2(224, 17), 5, true}, {{125.06, 19}, Point2(16, 17), 5, true}});
      EXPECT_TRUE(plan.stranded.empty()) << "pocket at " << x << ", " << depth << " deep";
    }
  }
}

TEST(JointPlan, TwoPocketsLetTwoRobotsPassTwo) {
  for (const int depth : {12, 16, 24}) {
    const OccupancyMap map = corridor_with_pockets(340, {120, 220}, depth);
    const JointPlan plan = solve(map, {{{159.84, 15}, Point2(310, 17), 5, true},
                                       {{146.82, 15}, Point2(298, 17), 5, true},
                                       {{183.48, 19}, Point2(32, 17), 5, true},
                                       {{170.33, 19}, Point2(20, 17), 5, true}});
    EXPECT_TRUE(plan.stranded.empty()) << depth << " deep";
  }
}

// Each robot blocks the moves by which the other would make way. One must step back first.
TEST(JointPlan, ADeadlockAtThePocketsMouthIsResolved) {
  OccupancyMap map = open_map(240, 64);
  block(map, 0, 0, 240, 64);
  block(map, 10, 10, 230, 24, false);
  block(map, 121, 24, 141, 40, false);
  const JointPlan plan = solve(
      map, {{{118.574868, 18.999996}, Point2(224, 17), 5}, {{127.79216, 15.000015}, Point2(16, 17), 5}});
  EXPECT_TRUE(plan.stranded.empty());
}

TEST(JointPlan, BothRobotsAreStrandedWithoutAPocket) {
  OccupancyMap map = open_map(200, 60);
  block(map, 0, 0, 200, 60);
  block(map, 0, 20, 200, 34, false);
  const JointPlan plan = solve(map, {{{10, 27}, Point2(190, 27), 5}, {{190, 27}, Point2(10, 27), 5}});
  EXPECT_EQ(plan.stranded.size(), 2u);
}

// Two robots can never pass each other. The others still reach their goals.
TEST(JointPlan, ALargeClusterIsSolvedExceptForTheImpossiblePart) {
  OccupancyMap map = open_map(300, 300);
  block(map, 0, 0, 300, 60);
  block(map, 10, 20, 290, 34, false);
  std::vector<JointTask> tasks{{{100, 27}, Point2(200, 27), 5}, {{200, 27}, Point2(100, 27), 5}};
  for (int k = 0; k < 14; ++k) {
    const double angle = 2 * std::numbers::pi * k / 14;
    const Point2 out = 80 * Point2(std::cos(angle), std::sin(angle));
    tasks.push_back({Point2(150, 180) + out, Point2(150, 180) - out, 5});
  }
  const JointPlan plan = solve(map, tasks);
  ASSERT_EQ(plan.stranded.size(), 1u);  // one makes room for the other
  EXPECT_LE(plan.stranded.front(), 1u);
  const ClearanceField field(map);
  MapRoadmaps roadmaps(field);
  JointPlanner planner(roadmaps, tasks, Random(1));
  int steps = 1;
  while (!planner.step()) ++steps;
  EXPECT_LT(steps, 1000);  // a search for parking vertices would take thousands
}

TEST(JointPlan, FiveRobotsPassFiveInACorridor) {
  for (const int width : {14, 24}) {
    std::vector<JointTask> tasks;
    for (int k = 0; k < 5; ++k) {
      tasks.push_back({{130.0 + 12 * k, 60.0}, Point2(390.0 - 12 * k, 60.0), 5});
      tasks.push_back({{270.0 - 12 * k, 60.0}, Point2(10.0 + 12 * k, 60.0), 5});
    }
    EXPECT_TRUE(solve(corridor(width), tasks).stranded.empty()) << width;
  }
}

TEST(JointPlan, ADeadEndIsFilledFromItsEnd) {
  OccupancyMap map = open_map(240, 100);
  block(map, 100, 0, 240, 100);
  block(map, 100, 40, 230, 54, false);
  std::vector<JointTask> tasks;
  // The robot that goes in deepest is the furthest away. Two stand in the dead end already, in the wrong
  // order.
  for (int k = 0; k < 4; ++k) tasks.push_back({{90.0 - 20 * k, 20.0}, Point2(180.0 + 12 * k, 47.0), 5});
  tasks.push_back({{150, 47}, Point2(160, 47), 5});
  tasks.push_back({{168, 47}, Point2(148, 47), 5});
  EXPECT_TRUE(solve(map, tasks).stranded.empty());
}

TEST(JointPlan, FiftyRobotsSwapOnACircle) {
  std::vector<JointTask> tasks;
  for (int k = 0; k < 50; ++k) {
    const double angle = 2 * std::numbers::pi * k / 50;
    const Point2 out = 200 * Point2(std::cos(angle), std::sin(angle));
    tasks.push_back({Point2(256, 256) + out, Point2(256, 256) - out, 5});
  }
  EXPECT_TRUE(solve(open_map(512, 512), tasks).stranded.empty());
}

TEST(JointPlan, FailedRobotsStayWhereTheyAre) {
  const JointPlan plan =
      solve(corridor(14), {{{100, 60}, Point2(320, 60), 5}, {{200, 60}, std::nullopt, 5, false}});
  EXPECT_EQ(plan.stranded.size(), 1u);
  EXPECT_TRUE(plan.moves.empty());
}

// The robot that stands nearest to the exit must go in deepest.
TEST(JointPlan, ADeadEndFilledInTheWrongOrderIsFilledAgain) {
  for (const int robots : {2, 6, 12}) {
    std::vector<JointTask> tasks;
    for (int k = 0; k < robots; ++k) tasks.push_back({{120.0 + 11 * k, 50}, Point2(280 - 11 * k, 50), 5});
    EXPECT_TRUE(solve(hall_and_aisle(), tasks).stranded.empty()) << robots;
  }
}

TEST(JointPlan, ADeadEndIsFilledAgainByRobotsOfSeveralSizes) {
  std::vector<JointTask> tasks;
  for (int k = 0; k < 6; ++k) tasks.push_back({{120.0 + 13 * k, 50}, Point2(280 - 13 * k, 50), 3 + 0.5 * k});
  EXPECT_TRUE(solve(hall_and_aisle(), tasks).stranded.empty());
}

/// The two largest exchange their sides of a gate, and need the room in which the small ones stand.
TEST(JointPlan, SmallRobotsMakeRoomForLargeOnes) {
  OccupancyMap map = open_map(18, 15);
  block(map, 6, 0, 7, 4);
  block(map, 12, 0, 13, 1);
  block(map, 6, 11, 7, 15);
  block(map, 12, 12, 13, 15);
  const JointPlan plan = solve(map, {{{12.5, 4.0083}, Point2(3.4814, 7.9819), 1.9529},
                                     {{15.5202, 5.7708}, Point2(15.5202, 5.7708), 0.83888},
                                     {{3.93, 11.9997}, Point2(3.93, 11.9997), 1.94421},
                                     {{15.02, 8.36}, Point2(15.02, 8.36), 0.64616},
                                     {{8.0509, 6.5453}, Point2(8.06, 6.55), 2.64862},
                                     {{1.5261, 5.3873}, Point2(1.5261, 5.3873), 1.28911}});
  EXPECT_TRUE(plan.stranded.empty());
}

TEST(JointPlan, ARobotAtItsGoalInADeadEndComesOutAndReturns) {
  const JointPlan plan =
      solve(hall_and_aisle(),
            {{{50, 50}, Point2(280, 50), 5}, {{200, 50}, Point2(200, 50), 5}, {{230, 50}, std::nullopt, 5}});
  EXPECT_TRUE(plan.stranded.empty());
}

// The branch of the corridor is a dead end, too.
TEST(JointPlan, TwoRobotsPassEachOtherAtTheBranchOfACorridor) {
  OccupancyMap map = open_map(200, 200);
  block(map, 0, 0, 200, 200);
  block(map, 10, 93, 190, 107, false);
  block(map, 93, 10, 107, 93, false);
  const JointPlan plan = solve(map, {{{30, 100}, Point2(170, 100), 5}, {{170, 100}, Point2(30, 100), 5}});
  EXPECT_TRUE(plan.stranded.empty());
}

TEST(JointPlan, ARobotBehindAFailedOneIsStrandedAndTheOthersArrive) {
  const JointPlan plan = solve(
      hall_and_aisle(),
      {{{60, 20}, Point2(280, 50), 5}, {{150, 50}, Point2(20, 80), 5}, {{230, 50}, std::nullopt, 5, false}});
  EXPECT_EQ(plan.stranded, std::vector<std::size_t>{0});
}

// It need not return, unlike a robot that stands at its goal.
TEST(JointPlan, ARobotWithoutAGoalLeavesTheGoalOfAnother) {
  for (const double radius : {5.0, 6.0}) {  // equal and different sizes use different searches
    const JointPlan plan =
        solve(corridor(14), {{{100, 60}, Point2(200, 60), 5}, {{200, 60}, std::nullopt, radius}});
    EXPECT_TRUE(plan.stranded.empty()) << radius;
  }
  const JointPlan plan =
      solve(corridor(14), {{{100, 60}, Point2(200, 60), 5}, {{200, 60}, Point2(200, 60), 5}});
  EXPECT_EQ(plan.stranded.size(), 1u);
}

TEST(JointPlan, ThePageListsTheStrategiesInTheirOrder) {
  const std::string page = test::contents(COPPICE_SOURCE_DIR "/docs/coordination.md");
  std::size_t at = 0;
  for (const JointPlanner::Strategy& strategy : JointPlanner::strategies()) {
    const std::string row =
        "\n| " + std::string(strategy.name) + " | " + std::string(strategy.serves) + " | ";
    at = page.find(row, at);
    ASSERT_NE(at, std::string::npos) << row;
  }
}

TEST(JointPlan, TwentyRobotsArriveInRoomsAndMaze) {
  for (const MapKind kind : {MapKind::room, MapKind::maze}) {
    Random random(3);
    const OccupancyMap map = generate_map(kind, 512, 512, random);
    std::vector<JointTask> tasks;
    for (const StartAndGoal& task : random_tasks(ClearanceField(map), 20, 5, 0, random))
      tasks.push_back({task.start, task.goal, 5});
    EXPECT_TRUE(solve(map, tasks).stranded.empty()) << static_cast<int>(kind);
  }
}

}  // namespace
}  // namespace coppice
