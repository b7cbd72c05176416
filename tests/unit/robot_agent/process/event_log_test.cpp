// Tests of what an agent logs.
#include "robot_agent/process/event_log.h"

#include <gtest/gtest.h>

#include "robot_agent/control/words.h"

namespace coppice {
namespace {

const Mission mission{.robot = "a",
                      .number = 1,
                      .map_id = "m",
                      .start = {1, 2},
                      .goal = {30, 40},
                      .radius = 0.5,
                      .max_speed = 2,
                      .clock = {100, 1}};

std::vector<std::string> texts(const std::vector<EventLog::Line>& lines) {
  std::vector<std::string> all;
  for (const EventLog::Line& line : lines) all.push_back((line.is_warning ? "! " : "") + line.text);
  return all;
}

AgentStatus status(Phase phase) {
  return {.robot = "a", .mission = 1, .phase = phase, .reason = {}, .run = {100}};
}

class EventLogTest : public testing::Test {
 protected:
  EventLogTest() { event_log.heard(mission); }
  std::vector<std::string> said(const Message& message, double fleet_time) {
    return texts(event_log.said(message, 100 + fleet_time));
  }
  using Lines = std::vector<std::string>;
  EventLog event_log{"a"};
};

TEST_F(EventLogTest, AMissionAPathAndAnArrivalAreALineEach) {
  EXPECT_EQ(said(status(Phase::planning), 0),
            Lines{"mission 1: from (1.00, 2.00) to (30.00, 40.00), radius 0.5 m, 2 m/s"});
  EXPECT_EQ(said(PathMessage{"a", 1, {{0, 0}, {30, 40}}, 100}, 0.5), Lines{"path of 50.0 m"});
  EXPECT_TRUE(said(PathMessage{"a", 1, {{0, 0}, {30, 39.9}}, 100}, 0.6).empty());
  EXPECT_EQ(said(PathMessage{"a", 1, {{0, 0}, {30, 30}}, 100}, 0.7), Lines{"another path of 42.4 m"});
  EXPECT_TRUE(said(status(Phase::driving), 1).empty());
  AgentStatus there = status(Phase::arrived);
  there.arrival_time = 25.5;
  there.driven_length = 51;
  EXPECT_EQ(said(there, 26), Lines{"arrived at 25.5 s, after 51.0 m"});
  EXPECT_TRUE(said(there, 26.5).empty());
}

TEST_F(EventLogTest, AWaitIsLoggedWithItsCause) {
  said(status(Phase::driving), 0);
  AgentStatus waits = status(Phase::driving);
  waits.came_on_at = 10;
  waits.wait_cause = "it waits for r7";
  EXPECT_TRUE(said(waits, 19).empty()) << "not before ten seconds";
  EXPECT_EQ(said(waits, 20.5), Lines{"has not come on since 10.0 s: it waits for r7"});
  EXPECT_TRUE(said(waits, 35).empty());
  EXPECT_EQ(said(waits, 40.5), Lines{"! has not come on since 10.0 s: it waits for r7"});
  EXPECT_TRUE(said(waits, 100).empty()) << "and not again";
  waits.wait_cause = "no odometry came";
  EXPECT_EQ(said(waits, 101), Lines{"! has not come on since 10.0 s: no odometry came"});
  AgentStatus goes_on = status(Phase::driving);
  goes_on.came_on_at = 110;
  EXPECT_EQ(said(goes_on, 110.5), Lines{"goes on after 100.5 s"});
}

TEST_F(EventLogTest, ARobotWithoutAPathIsLoggedAsAWarning) {
  AgentStatus stuck = status(Phase::no_path);
  stuck.reason = "the goal cannot be reached";
  EXPECT_EQ(said(stuck, 1).back(), "! the goal cannot be reached");
}

TEST(EventLog, AnAgentWithoutAMissionLogsWhy) {
  EventLog event_log("r9");
  AgentStatus waits{.robot = "r9"};
  EXPECT_TRUE(event_log.said(waits, 1).empty());
  waits.reason = "no mission for r9: the run has 2 robots, a to b";
  EXPECT_EQ(texts(event_log.said(waits, 2)), std::vector<std::string>{"! " + waits.reason});
  EXPECT_TRUE(event_log.said(waits, 3).empty());
}

TEST_F(EventLogTest, MissedControlPeriodsAreLoggedOnceAMinute) {
  said(status(Phase::driving), 0);
  std::vector<std::string> all;
  AgentStatus busy = status(Phase::driving);
  for (int k = 1; k <= 100; ++k) {
    busy.load.periods += 20;
    busy.load.periods_missed += 5;
    for (const std::string& line : said(busy, k)) all.push_back(line);
  }
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0], "! missed 50 of 200 control periods in 10 s: it gets too little processor time");
}

TEST_F(EventLogTest, FewMissedControlPeriodsAreNotLogged) {
  said(status(Phase::driving), 0);
  AgentStatus fine = status(Phase::driving);
  for (int k = 1; k <= 100; ++k) {
    fine.load.periods += 20;
    fine.load.periods_missed += 1;
    EXPECT_TRUE(said(fine, k).empty());
  }
}

TEST(EventLogWords, ReasonsAreCutAtWholeCharacters) {
  EXPECT_EQ(bounded("short"), "short");
  std::string text(longest_reason - 1, 'x');
  EXPECT_EQ(bounded(text + "\u00e4\u00e4"), text);
}

TEST(EventLogWords, NamesAreListedInNumericalOrder) {
  EXPECT_EQ(listed({}), "nobody");
  EXPECT_EQ(listed({"r10", "r9"}), "r9 and r10");
  EXPECT_EQ(listed({"r10", "r9", "r1", "r2"}), "r1, r2 and 2 more");
}

}  // namespace
}  // namespace coppice
