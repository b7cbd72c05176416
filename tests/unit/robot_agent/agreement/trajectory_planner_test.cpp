// Tests of the trajectory of a reservation: around all others, or around as many as possible.
#include "robot_agent/agreement/trajectory_planner.h"

#include <gtest/gtest.h>

#include "tests/unit/motion/plans.h"
#include "tests/usual_robot.h"
#include "tests/winding_map.h"

namespace coppice {
namespace {

using test::limits;
using test::radius;

class TrajectoryPlannerTest : public testing::Test {
 protected:
  static OtherRobot robot(const char* name, Trajectory trajectory, bool may_give_way = true) {
    return {.position = trajectory.front().position,
            .radius = radius,
            .reservation = KnownReservation{{name, 1, 0}, trajectory, radius},
            .may_give_way = may_give_way};
  }
  TrajectoryPlanner planner(std::vector<OtherRobot> others) {
    return {roadmaps, path, radius, limits, 0, std::move(others), {}};
  }
  static bool keeps_apart(const Trajectory& own, const OtherRobot& other) {
    return !come_too_close(own, other.reservation->trajectory, kept_apart(radius, radius) - 1e-6, 0);
  }

  /// A corridor in which robots cannot pass each other.
  ClearanceField field{[] {
    OccupancyMap map{.width = 200, .height = 14, .blocked = std::vector<std::uint8_t>(2800, 0)};
    return map;
  }()};
  MapRoadmaps roadmaps{field};
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

/// A way of 20 km, which is 49,000 radii.
class LongWay : public testing::Test {
 protected:
  static constexpr double small = 0.4;
  static constexpr int side = 400;
  static constexpr Limits slow{1, 2};

  TrajectoryPlanner planner(std::vector<OtherRobot> others) {
    return {roadmaps, way, small, slow, 0, std::move(others), {}};
  }

  ClearanceField field{test::winding_map(side)};
  MapRoadmaps roadmaps{field};
  Path way = test::way_through(side / 8, side);
};

TEST_F(LongWay, IsReservedInPartsThatFollowOnEachOther) {
  Path left = way;
  int parts = 0;
  for (; left.size() > 1 && parts < 10; ++parts) {
    TrajectoryPlanner alone(roadmaps, left, small, slow, 0, {}, {});
    const auto found = alone.around_all();
    ASSERT_TRUE(found);
    EXPECT_LE(length_of(path_of(*found)), 1.01 * 16'000 * small);  // with wide corners
    EXPECT_EQ(found->front().position, left.front());
    EXPECT_EQ(found->back().position, alone.rest().empty() ? left.back() : alone.rest().front());
    left = Path(alone.rest());
  }
  EXPECT_EQ(parts, 4);
}

TEST_F(LongWay, LeadsPastARobotThatStandsOnIt) {
  OtherRobot stands{
      .position = test::in_corridor(0, 100), .radius = small, .stands_until = SpaceTime::forever};
  TrajectoryPlanner around = planner({stands});
  const auto found = around.around_all();
  ASSERT_TRUE(found);
  EXPECT_FALSE(come_too_close(*found, {{0, stands.position}}, kept_apart(small, small) - 1e-6, 0));
  EXPECT_GT(length_of(path_of(*found)), 100);
}

TEST_F(LongWay, EndsBeforeAMeetingThatIsFarAway) {
  OtherRobot stands{
      .position = test::in_corridor(10, 200), .radius = small, .stands_until = SpaceTime::forever};
  TrajectoryPlanner before = planner({stands});
  const auto found = before.around_all();
  ASSERT_TRUE(found);
  const double length = length_of(path_of(*found));
  EXPECT_GT(length, 1'600);
  EXPECT_LT(length, 4'200);
}

TEST_F(LongWay, LeadsPastARobotThatComesTheOtherWay) {
  Trajectory back;
  double time = 0;
  for (const Point2& p : Path(way.rend() - 4, way.rend())) {
    if (!back.empty()) time += (p - back.back().position).norm() / slow.max_speed;
    back.push_back({time, p});
  }
  OtherRobot comes{.position = back.front().position,
                   .radius = small,
                   .reservation = KnownReservation{{"comes", 1, 0}, back, small}};
  way.front() = test::in_corridor(0, 50);
  TrajectoryPlanner around = planner({comes});
  const auto found = around.around_all();
  ASSERT_TRUE(found);
  EXPECT_FALSE(come_too_close(*found, back, kept_apart(small, small) - 1e-6, 0));
}

TEST(LargeMap, IsSearchedInParts) {
  constexpr double small = 0.4;
  constexpr int side = 1'500;
  const ClearanceField field(test::winding_map(side));
  MapRoadmaps roadmaps(field);
  ASSERT_FALSE(roadmaps.has_lattice(small));
  const Path way{test::in_corridor(0, 10), test::in_corridor(0, 1'000)};
  OtherRobot stands{
      .position = test::in_corridor(0, 100), .radius = small, .stands_until = SpaceTime::forever};
  TrajectoryPlanner around(roadmaps, way, small, {1, 2}, 0, {stands}, {});
  const auto found = around.around_all();
  ASSERT_TRUE(found);
  EXPECT_FALSE(come_too_close(*found, {{0, stands.position}}, kept_apart(small, small) - 1e-6, 0));
}

}  // namespace
}  // namespace coppice
