// Tests of what `coppice top` shows of a fleet.
#include "monitor/view/fleet_table.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

struct FleetTableTest : testing::Test {
  template <class M>
  void hear(M message, WallTime at = 100) {
    view.on(std::make_shared<const Message>(std::move(message)), at);
  }
  void add(const RobotName& name, Phase phase, const Point2& place, double stamp) {
    hear(
        Mission{.robot = name, .number = 1, .map_id = "m", .goal = {100, 0}, .radius = 1, .clock = {100, 1}});
    hear(PathMessage{name, 1, {place, {100, 0}}});
    hear(
        RobotState{
            .robot = name, .promise = {.stamp = stamp, .position = place}, .radius = 1, .phase = phase},
        100 + stamp);
  }
  std::vector<std::string> names(RobotOrder order) const {
    std::vector<std::string> first_words;
    for (const std::string& row : fleet_table(view, order, 110).rows)
      first_words.push_back(row.substr(0, row.find(' ')));
    return first_words;
  }
  FleetView view;
};

TEST_F(FleetTableTest, TheTableSaysThatNothingWasHeard) {
  const FleetTable table = fleet_table(view, RobotOrder::name, 100);
  EXPECT_EQ(table.summary, std::vector<std::string>{"no robot has been heard yet"});
  EXPECT_TRUE(table.rows.empty());
}

TEST_F(FleetTableTest, TheRowsAreSortedInTheChosenOrder) {
  add("r10", Phase::driving, {90, 0}, 9);
  add("r2", Phase::arrived, {100, 0}, 10);
  add("r1", Phase::no_path, {20, 0}, 2);
  hear(AgentStatus{.robot = "r10", .load = {.periods = 100, .periods_missed = 1}});
  hear(AgentStatus{.robot = "r10", .load = {.periods = 200, .periods_missed = 51}});
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(RobotOrder::name), (Names{"r1", "r2", "r10"}));
  EXPECT_EQ(names(RobotOrder::phase), (Names{"r1", "r10", "r2"}));
  EXPECT_EQ(names(RobotOrder::to_goal), (Names{"r1", "r10", "r2"}));
  EXPECT_EQ(names(RobotOrder::age), (Names{"r1", "r10", "r2"}));
  EXPECT_EQ(names(RobotOrder::missed), (Names{"r10", "r1", "r2"}));
}

TEST_F(FleetTableTest, TheTableShowsEachRobotInARow) {
  add("r1", Phase::driving, {20.25, 3}, 9.5);
  hear(AgentStatus{.robot = "r1", .mission = 1, .phase = Phase::driving, .driven_length = 12.5});
  const FleetTable table = fleet_table(view, RobotOrder::name, 110);
  ASSERT_EQ(table.rows.size(), 1u);
  for (const char* part : {"r1", "driving", "20.2", "3.0", "79.8", "12.5", "0.50"})
    EXPECT_NE(table.rows[0].find(part), std::string::npos) << part << " in " << table.rows[0];
  EXPECT_EQ(table.rows[0].rfind('-'), table.header.find("WAITS")) << "the robot makes progress";
  EXPECT_NE(table.summary[0].find("fleet time 10.0 s"), std::string::npos) << table.summary[0];
}

TEST_F(FleetTableTest, TheTableShowsTheLengthOfTheRemainingPath) {
  add("r1", Phase::driving, {20, 0}, 9.5);
  hear(PathMessage{"r1", 1, {{20, 0}, {20, 30}, {100, 30}, {100, 0}}});  // around an obstacle
  const FleetTable table = fleet_table(view, RobotOrder::name, 110);
  EXPECT_NE(table.rows.at(0).find(" 140.0 "), std::string::npos) << table.rows.at(0);
}

TEST_F(FleetTableTest, TheTableShowsTheWaitCauseThatTheAgentGives) {
  add("r1", Phase::driving, {20, 3}, 9.5);
  hear(AgentStatus{.robot = "r1",
                   .mission = 1,
                   .phase = Phase::driving,
                   .wait_cause = "it waits for r7, which goes first by the joint plan",
                   .came_on_at = 4});
  const FleetTable table = fleet_table(view, RobotOrder::name, 116);
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.rows[0].substr(table.header.find("WAITS")),
            "12 s: it waits for r7, which goes first by the joint plan");
}

TEST(RobotOrder, AnOrderIsFoundByItsName) {
  EXPECT_EQ(robot_order("to-goal"), RobotOrder::to_goal);
  EXPECT_EQ(robot_order("size"), std::nullopt);
}

}  // namespace
}  // namespace coppice
