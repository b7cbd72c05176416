#include "robot_agent/agreement/joint_tasks.h"

#include <gtest/gtest.h>

#include "motion/trajectory/segments.h"
#include "tests/unit/motion/plans.h"

namespace coppice {
namespace {

FleetMember member(const Point2& at, std::optional<Point2> goal, bool arrived = false) {
  FleetMember m;
  m.position = at;
  m.goal = goal;
  m.arrives_within = 0.5;
  m.wants_to_stay = arrived;
  m.radius = 5;
  return m;
}

std::vector<JointTask> tasks_of(const std::vector<FleetMember>& members,
                                const std::vector<JointTask>& obstacles = {}) {
  return joint_tasks(members, obstacles, ClearanceField(test::open_map(200, 200)));
}

/// Checks that the goals are apart, and that each is within its robot's arrival tolerance.
void expect_room_for_all(const std::vector<FleetMember>& members, const std::vector<JointTask>& tasks) {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (i < members.size()) {
      EXPECT_LE((*tasks[i].goal - *members[i].goal).norm(), members[i].arrives_within);
    }
    for (std::size_t k = 0; k < i && k < members.size(); ++k) {
      const Point2 end = tasks[i].movable ? *tasks[i].goal : tasks[i].position;
      EXPECT_GE((end - *tasks[k].goal).norm(), tasks[i].radius + tasks[k].radius + standing_gap)
          << i << " " << k;
    }
  }
}

TEST(JointTasks, GoalsThatLeaveRoomStayAsTheyAre) {
  const std::vector<JointTask> tasks =
      tasks_of({member({20, 20}, Point2(100, 100)), member({50, 20}, Point2(111, 100))});
  EXPECT_EQ(*tasks[0].goal, Point2(100, 100));
  EXPECT_EQ(*tasks[1].goal, Point2(111, 100));
}

TEST(JointTasks, GoalsThatTouchAreMovedApart) {
  std::vector<FleetMember> members;
  for (int k = 0; k < 49; ++k)
    members.push_back(member({20, 20}, Point2(100 + 10 * (k % 7), 100 + 10 * (k / 7))));
  expect_room_for_all(members, tasks_of(members));
}

TEST(JointTasks, AnArrivedRobotStaysIfOthersHaveRoom) {
  const std::vector<FleetMember> members{member({100.3, 100}, Point2(100, 100), true),
                                         member({20, 20}, Point2(110.2, 100))};
  const std::vector<JointTask> tasks = tasks_of(members);
  EXPECT_EQ(*tasks[0].goal, members[0].position);
  expect_room_for_all(members, tasks);
}

TEST(JointTasks, AnArrivedRobotMovesIfAnotherHasNoOtherRoom) {
  const std::vector<FleetMember> members{member({90.3, 100}, Point2(90, 100), true),
                                         member({110, 100}, Point2(110, 100), true),
                                         member({20, 20}, Point2(100, 100))};
  expect_room_for_all(members, tasks_of(members));
}

TEST(JointTasks, TheGoalKeepsClearOfAnObstacleThatCoversItInPart) {
  const std::vector<FleetMember> members{member({20, 20}, Point2(100, 100))};
  expect_room_for_all(members, tasks_of(members, {{{109.8, 100}, std::nullopt, 5, false}}));
}

TEST(JointTasks, ARobotWithoutAReachableGoalMayBeSentAnywhere) {
  EXPECT_FALSE(tasks_of({member({20, 20}, std::nullopt)})[0].goal);
  EXPECT_FALSE(tasks_of({member({20, 20}, Point2(1000, 20))})[0].goal);
}

}  // namespace
}  // namespace coppice
