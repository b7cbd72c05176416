// Tests of the trajectory of a reservation: around all others, or around as many as possible.
#include "robot_agent/trajectory_planner.h"

#include <gtest/gtest.h>

#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

constexpr double radius = 5;
const Limits limits{20, 40};

class TrajectoryPlannerTest : public testing::Test {
 protected:
  static OtherRobot robot(const char* name, Trajectory trajectory, bool may_give_way = true) {
    return {.position = trajectory.front().position,
            .radius = radius,
            .reservation = KnownReservation{{name, 1, 0}, trajectory, radius},
            .may_give_way = may_give_way};
  }
  TrajectoryPlanner planner(std::vector<OtherRobot> others) {
    return {places, path, radius, limits, 0, std::move(others), {}};
  }
  static bool keeps_apart(const Trajectory& own, const OtherRobot& other) {
    return !come_too_close(own, other.reservation->trajectory, kept_apart(radius, radius) - 1e-6, 0);
  }

  /// A corridor in which robots cannot pass each other.
  ClearanceField field{[] {
    OccupancyMap map{.width = 200, .height = 14, .blocked = std::vector<std::uint8_t>(2800, 0)};
    return map;
  }()};
  MapRoadmaps places{field};
  Path path{{60, 7}, {180, 7}};
  OtherRobot ahead = robot("ahead", {{0, {80, 7}}, {3, {110, 7}}, {6, {110, 7}}, {10, {195, 7}}});
};

TEST_F(TrajectoryPlannerTest, ATrajectoryKeepsClearOfAllOthers) {
  TrajectoryPlanner around = planner({ahead});
  const auto found = around.around_all();
  ASSERT_TRUE(found);
  EXPECT_TRUE(keeps_apart(*found, ahead));
  EXPECT_EQ(found->back().position, path.back());
  ASSERT_EQ(around.basis().size(), 1u);
}

TEST_F(TrajectoryPlannerTest, ThereIsNoneIfOthersCloseTheWayForGood) {
  TrajectoryPlanner around = planner({robot("stays", {{0, {100, 7}}, {1, {120, 7}}})});
  EXPECT_FALSE(around.around_all());
}

// "blocker" is to come over the start, and to stay in the way. "ahead" drives on.
TEST_F(TrajectoryPlannerTest, NoMoreRobotsGiveWayThanMust) {
  OtherRobot blocker = robot("blocker", {{0, {30, 7}}, {2, {90, 7}}, {3, {120, 7}}});
  TrajectoryPlanner around = planner({blocker, ahead});
  ASSERT_FALSE(around.around_all());
  const auto found = around.around_most();
  ASSERT_TRUE(found);
  EXPECT_TRUE(keeps_apart(*found, ahead));
  ASSERT_EQ(around.basis().size(), 1u);
  EXPECT_EQ(around.basis().front().robot, "ahead");
}

TEST_F(TrajectoryPlannerTest, RobotsThatMayNotGiveWayDoNot) {
  TrajectoryPlanner around = planner({robot("stays", {{0, {100, 7}}, {1, {120, 7}}}, false), ahead});
  EXPECT_FALSE(around.around_all());
  EXPECT_FALSE(around.around_most());
}

TEST_F(TrajectoryPlannerTest, ARobotThatGivesWayStandsForAWhile) {
  OtherRobot stays = robot("stays", {{0, {100, 7}}, {1, {120, 7}}});
  stays.stands_until = 5;
  TrajectoryPlanner around = planner({stays});
  const auto found = around.around_most();
  ASSERT_TRUE(found);
  EXPECT_TRUE(around.basis().empty());
  EXPECT_GT(found->back().time, 5 + 4);
}

}  // namespace
}  // namespace coppice
