// Tests of the priority in which a robot plans its reservation.
#include "robot_agent/agreement/priority.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/motion/plans.h"
#include "tests/usual_robot.h"

namespace coppice {
namespace {

using test::radius;

/// A corridor from left to right, 200 m long, between walls.
ClearanceField corridor(std::size_t width) {
  OccupancyMap map{.width = 200, .height = 100, .blocked = std::vector<std::uint8_t>(20'000, 1)};
  for (std::size_t y = 50 - width / 2; y < 50 + width / 2; ++y)
    std::fill_n(map.blocked.begin() + static_cast<std::ptrdiff_t>(y * 200), 200, std::uint8_t{0});
  return ClearanceField(map);
}

TEST(Priority, ARobotInACorridorForOneClosesIt) {
  EXPECT_TRUE(closes_a_passage({100, 50}, radius, corridor(14)));
  EXPECT_TRUE(closes_a_passage({100, 50}, radius, corridor(30)));  // it stands in the middle
}

TEST(Priority, ARobotThatOthersGetPastClosesNothing) {
  EXPECT_FALSE(closes_a_passage({100, 31}, radius, corridor(50)));
  EXPECT_FALSE(closes_a_passage({100, 50}, radius, corridor(80)));
  EXPECT_FALSE(closes_a_passage({5.1, 50}, radius, corridor(14)));  // at the dead end
}

TEST(Priority, ThePriorityFollowsFromTheWay) {
  const ClearanceField field = corridor(14);
  EXPECT_EQ(priority_of({{20, 50}, {100, 50}}, radius, field), Priority::last);
  EXPECT_EQ(priority_of({{100, 50}, {5.1, 50}}, radius, field), Priority::usual);
  EXPECT_EQ(priority_of({{60, 50}, {180, 50}, {100, 50}}, radius, field), Priority::winding);
}

TEST(Priority, ShortWaysAreFirstAmongUsualOnesAndLongWaysAmongTheRest) {
  EXPECT_TRUE(plans_first(Priority::usual, 10, "b", Priority::usual, 20, "a"));
  for (const Priority priority : {Priority::urgent, Priority::winding, Priority::last})
    EXPECT_TRUE(plans_first(priority, 20, "b", priority, 10, "a"));
  EXPECT_TRUE(plans_first(Priority::usual, 10, "a", Priority::usual, 10, "b"));
}

TEST(Priority, TheOrderIsStrictAndComplete) {
  struct Robot {
    Priority priority;
    double way;
    RobotName name;
  };
  std::vector<Robot> robots;
  for (const Priority priority : {Priority::urgent, Priority::winding, Priority::usual, Priority::last})
    for (const double way : {10.0, 20.0})
      for (const char* name : {"a", "b"}) robots.push_back({priority, way, name});
  const auto first = [](const Robot& a, const Robot& b) {
    return plans_first(a.priority, a.way, a.name, b.priority, b.way, b.name);
  };
  for (const Robot& a : robots) {
    EXPECT_FALSE(first(a, a));
    for (const Robot& b : robots) EXPECT_TRUE(&a == &b || first(a, b) != first(b, a));
  }
  std::ranges::sort(robots, first);
  EXPECT_EQ(robots.front().priority, Priority::urgent);
  EXPECT_EQ(robots.back().priority, Priority::last);
}

}  // namespace
}  // namespace coppice
