// Tests of joint plans with room around the robots, wherever these stand when the plan is made.
#include "robot_agent/agreement/plan_maker.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "motion/trajectory/space_time.h"
#include "tests/unit/motion/plans.h"
#include "tests/unit/motion/trajectories.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::radius;

FleetMember member(const RobotName& name, const Point2& position, const Point2& goal) {
  FleetMember m;
  m.robot = name;
  m.position = position;
  m.goal = goal;
  m.arrives_within = 0.5;
  m.radius = radius;
  m.stands = true;
  m.limits = {20, 40};
  return m;
}

std::vector<JointPlanMessage::Member> planned(const OccupancyMap& map, std::vector<FleetMember> members) {
  const ClearanceField field(map);
  MapRoadmaps roadmaps(field);
  PlanMaker maker(roadmaps, std::move(members), {}, {}, Random(1), 0);
  while (!maker.step(0, true)) {
  }
  EXPECT_FALSE(maker.strands());
  if (maker.strands()) return {};
  return maker.message().members;
}

/// A corridor along x: centres of robots between y = 25 and 45.
OccupancyMap corridor() {
  OccupancyMap map = test::open_map(300, 70);
  test::block(map, 0, 0, 300, 20);
  test::block(map, 0, 50, 300, 70);
  return map;
}

double least_distance(const Trajectory& a, const Trajectory& b, double from) {
  double least = 1e9;
  const double end = std::max(a.back().time, b.back().time);
  for (double time = from; time < end; time += 0.02)
    least = std::min(least, (test::position_at(a, time) - test::position_at(b, time)).norm());
  return least;
}

TEST(PlanMaker, ARobotThatStandsAtAWallLeavesIt) {
  const auto members =
      planned(corridor(), {member("a", {40, 25.004}, {260, 35}), member("b", {260, 35}, {40, 35})});
  ASSERT_EQ(members.size(), 2u);
  const Trajectory& a = members[0].trajectory;
  EXPECT_EQ(a.front().position, Point2(40, 25.004));
  EXPECT_EQ(a.back().position, Point2(260, 35));
  EXPECT_GE(least_distance(a, members[1].trajectory, 0), kept_apart(radius, radius) - 1e-6);
  const auto is_roomy = [](const TimedPoint& p) {
    return p.position.x() < 60 || p.position.y() >= 25 + reserved_stray_radii * radius - 1e-6;
  };
  EXPECT_TRUE(std::ranges::all_of(a, is_roomy));
}

TEST(PlanMaker, RobotsThatStandCloselyDriveApart) {
  const auto members =
      planned(corridor(), {member("a", {40, 30}, {260, 42}), member("b", {40, 40.05}, {260, 28})});
  const Trajectory& a = members[0].trajectory;
  const Trajectory& b = members[1].trajectory;
  EXPECT_EQ(a.back().position, Point2(260, 42));
  EXPECT_EQ(b.back().position, Point2(260, 28));
  EXPECT_GE(least_distance(a, b, 0), 2 * radius);
  const double soon = std::max(a.front().time, b.front().time) + 4;
  EXPECT_GE(least_distance(a, b, soon), kept_apart(radius, radius) - 1e-6);
}

/// Two columns pass each other in the corridor. A robot that is no member closes it for a minute.
TEST(PlanMaker, APlanIsChosenThoughLaterOnesWouldWaitLess) {
  const OccupancyMap map = corridor();
  const ClearanceField field(map);
  MapRoadmaps roadmaps(field);
  std::vector<FleetMember> members;
  for (int k = 0; k < 5; ++k) {
    members.push_back(member("a" + std::to_string(k), {20.0 + 14 * k, 35}, {280.0 - 14 * k, 35}));
    members.push_back(member("b" + std::to_string(k), {280.0 - 14 * k, 35}, {20.0 + 14 * k, 35}));
  }
  const double large = 9;
  const KnownReservation other{{"c", 1, 0}, {{0, {150, 35}}, {60, {150, 35}}, {62, {150, 69}}}, large};
  PlanMaker maker(roadmaps, members, {}, {&other, 1}, Random(1), 0);
  double now = 0;
  while (!maker.step(now, true) && now < 20) now += 0.05;
  EXPECT_LT(now, 5);
  EXPECT_FALSE(maker.strands());
  EXPECT_EQ(maker.message().members.size(), members.size());
}

constexpr double cell = 0.0754;  // metres

/// Radius and places in cells.
FleetMember on_cells(const RobotName& name, double its_radius, const Point2& position, const Point2& goal) {
  FleetMember m = member(name, cell * position, cell * goal);
  m.radius = cell * its_radius;
  m.arrives_within = 0.1 * cell;
  m.limits = {1, 1};
  m.wants_to_stay = (m.position - *m.goal).norm() < m.arrives_within;
  return m;
}

/// The passage of the two that drive is closed while r5 stands a tenth of its radius off its goal.
TEST(PlanMaker, ARobotThatArrivedGoesToItsVeryGoalWhereOthersNeedTheRoom) {
  constexpr std::string_view rows = "....|....|....|##..|.#..|...#|.#..|...#|....|.##.|....|";
  OccupancyMap map{.width = 4, .height = 11, .resolution = cell, .blocked = {}};
  for (const char c : rows) {
    if (c != '|') map.blocked.push_back(c == '#');
  }
  std::vector<FleetMember> members{on_cells("r2", 0.359, {1.249, 5.56}, {3.5, 9.5})};
  members.push_back(on_cells("r1", 0.45, {2.5, 3.545}, {2.5, 3.5}));
  members.push_back(on_cells("r3", 0.45, {0.5, 9.5}, {0.5, 9.5}));
  members.push_back(on_cells("r4", 0.45, {0.51, 4.588}, {1.5, 1.5}));
  members.push_back(on_cells("r5", 0.45, {2.5, 2.455}, {2.5, 2.5}));
  members.push_back(on_cells("r6", 0.45, {0.5, 1.5}, {0.5, 1.5}));
  members.push_back(on_cells("r7", 0.364, {2.5, 6.5}, {2.5, 6.5}));
  members.push_back(on_cells("r8", 0.265, {3.5, 8.5}, {3.5, 8.5}));
  planned(map, std::move(members));
}

}  // namespace
}  // namespace coppice
