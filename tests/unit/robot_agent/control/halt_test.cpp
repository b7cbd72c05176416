// Tests of robots that an operator pauses or stops.
#include <gtest/gtest.h>

#include "motion/body/promise.h"
#include "tests/unit/robot_agent/agent_run.h"

namespace coppice {
namespace {

struct Drive : AgentRun {
  Drive() {
    hear(map_message(), 0);
    hear(mission_of_a(0), 0);
    run(0, 3);
  }
  AgentStatus last() const { return of<AgentStatus>(said).back(); }
  std::vector<TrackMessage::Point> track() const { return track_in(said); }
};

TEST(Halt, AStoppedRobotBrakesAtOnceAndStandsUntilItIsReleased) {
  Drive drive;
  ASSERT_EQ(drive.last().phase, Phase::driving);
  ASSERT_GT(of<RobotState>(drive.said).back().promise.velocity.norm(), 5);
  drive.hear(HaltMessage{.number = 1, .everybody = Halt::stopped}, 3);
  drive.run(3, 30);
  EXPECT_EQ(drive.last().phase, Phase::halted);
  EXPECT_EQ(drive.last().reason, "stopped by the operator");
  EXPECT_EQ(of<ReservationMessage>(drive.said).back().trajectory.size(), 0u) << "nobody waits for it";
  const double stands_by = 3 + 2 * control_period + 20.0 / 40;
  for (const auto& point : drive.track()) {
    const bool brakes = point.time <= stands_by;
    EXPECT_TRUE(brakes || point.velocity.isZero(1e-12)) << point.time;
  }
  drive.hear(HaltMessage{.number = 2}, 30);
  drive.run(30, 60);
  EXPECT_EQ(drive.last().phase, Phase::arrived);
  EXPECT_EQ(drive.last().reason, "");
}

TEST(Halt, APauseSaysThatItIsOne) {
  Drive drive;
  drive.hear(HaltMessage{.number = 1, .robots = {{"b", Halt::stopped}}}, 3);
  drive.run(3, 4);
  EXPECT_EQ(drive.last().phase, Phase::driving) << "it is for another robot";
  drive.hear(HaltMessage{.number = 2, .robots = {{"a", Halt::paused}}}, 4);
  drive.run(4, 6);
  EXPECT_EQ(drive.last().reason, "paused by the operator");
  drive.hear(HaltMessage{.number = 1}, 6);
  drive.run(6, 8);
  EXPECT_EQ(drive.last().phase, Phase::halted) << "an older message changes nothing";
  drive.hear(HaltMessage{.number = 3, .robots = {{"a", Halt::stopped}}}, 8);
  drive.run(8, 9);
  EXPECT_EQ(drive.last().reason, "stopped by the operator");
}

TEST(Halt, ARobotThatGetsAMissionWhileItIsHaltedSetsOutWhenItIsReleased) {
  AgentRun run;
  run.hear(map_message(), 0);
  run.hear(HaltMessage{.number = 1, .everybody = Halt::paused}, 0);
  run.hear(mission_of_a(0), 0);
  run.run(0, 5);
  EXPECT_EQ(of<AgentStatus>(run.said).back().phase, Phase::halted);
  EXPECT_EQ(of<RobotState>(run.said).back().promise.position, Point2(20, 60));
  Mission next = mission_of_a(0, {40, 60});
  next.number = 2;
  run.hear(next, 5);
  run.run(5, 10);
  EXPECT_EQ(of<AgentStatus>(run.said).back().phase, Phase::halted);
  EXPECT_EQ(of<AgentStatus>(run.said).back().mission, 2u);
  run.hear(HaltMessage{.number = 2}, 10);
  run.run(10, 30);
  EXPECT_EQ(of<AgentStatus>(run.said).back().phase, Phase::arrived);
}

TEST(Halt, ARestartedAgentStandsThoughNobodyTellsItAgain) {
  Drive before;
  before.hear(HaltMessage{.number = 1, .everybody = Halt::stopped}, 3);
  before.run(3, 6);
  AgentRun restarted;
  restarted.restore(before.store.messages);
  restarted.hear(map_message(), 7);
  restarted.hear(mission_of_a(0), 7);
  restarted.run(7, 30);
  EXPECT_EQ(of<AgentStatus>(restarted.said).back().phase, Phase::halted);
  EXPECT_TRUE(of<RobotState>(restarted.said).back().promise.stands());
  restarted.hear(HaltMessage{.number = 2}, 30);
  restarted.run(30, 60);
  EXPECT_EQ(of<AgentStatus>(restarted.said).back().phase, Phase::arrived);
}

}  // namespace
}  // namespace coppice
