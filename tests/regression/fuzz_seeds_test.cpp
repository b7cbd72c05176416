// Cases of `coppice fuzz` that failed once, each with its cause. If the cases that seeds draw change, the
// case itself must be stored here instead of its seed.
#include <gtest/gtest.h>

#include "simulation/fuzz.h"

namespace coppice {
namespace {

void expect_survived(const FuzzCase& fuzz_case) {
  FleetSimulation simulation(fuzz_case.scenario, fuzz_case.settings);
  simulation.run([](const PlannerService&, double) { return true; });
  for (const std::string& failure : judge(fuzz_case, simulation).failures)
    ADD_FAILURE() << fuzz_case.what << ": " << failure;
}

class FuzzSeeds : public testing::TestWithParam<std::uint32_t> {};

TEST_P(FuzzSeeds, TheCasePasses) {
  expect_survived(draw_fuzz_case(GetParam()));
}

class FuzzSeedsWithRestarts : public testing::TestWithParam<std::uint32_t> {};

TEST_P(FuzzSeedsWithRestarts, TheCasePasses) {
  expect_survived(draw_fuzz_case(GetParam(), true));
}

class FuzzSeedsOfDifferentialRobotsWithRestarts : public testing::TestWithParam<std::uint32_t> {};

TEST_P(FuzzSeedsOfDifferentialRobotsWithRestarts, TheCasePasses) {
  expect_survived(draw_fuzz_case(GetParam(), true, true));
}

INSTANTIATE_TEST_SUITE_P(
    PassingBehindTheGoal, FuzzSeeds,
    testing::Values(7));  // one robot must wait past its goal, and come back, while the other passes
INSTANTIATE_TEST_SUITE_P(LastStatesUnheard, FuzzSeeds, testing::Values(100456));
// A velocity jumps at the beginning of a control period. It does not change evenly within it.
INSTANTIATE_TEST_SUITE_P(TwoCreepingRobots, FuzzSeeds, testing::Values(100213));
INSTANTIATE_TEST_SUITE_P(CrossingWithLoss, FuzzSeeds,
                         testing::Values(1100));  // 40 robots, a third of the states lost
INSTANTIATE_TEST_SUITE_P(
    MutualAvoidance, FuzzSeeds,
    testing::Values(1095,    // with a delay of 0.24 s, robots that executed a plan avoided each
                    1155));  // other's next move for ever: none committed to stand for long
// Two robots met head-on in a corridor. Each assumed that the peer that it had just pushed back drove in its
// own direction. They let each other go first for ever, and the time for which they stood did not count as
// being without progress.
INSTANTIATE_TEST_SUITE_P(PushedToAndFro, FuzzSeeds, testing::Values(1000588));
// A joint plan led a robot away from its new goal. The robot took the plan's path for its own, and reserved a
// way of no length again and again.
INSTANTIATE_TEST_SUITE_P(LedAway, FuzzSeeds, testing::Values(8300043));

// A robot waited at a gate very close to the end of a leg, and counted as being at the end. So the gate lay
// behind it, and it drove past another robot that was to go first.
INSTANTIATE_TEST_SUITE_P(GateAtTheEndOfALeg, FuzzSeeds, testing::Values(12700135));

// The network was partitioned when some robots had heard of each other and some had not come yet. The first
// were suspected one by one, the others given up later. So no robot counted all that were in the other part.
INSTANTIATE_TEST_SUITE_P(PartitionedWhileTheRobotsCome, FuzzSeeds, testing::Values(13400004));

// A robot fell silent, was heard again, and failed elsewhere while another agent was down. That agent knew
// only of the silence, and drove into the robot.
INSTANTIATE_TEST_SUITE_P(FailedUnseen, FuzzSeedsWithRestarts, testing::Values(1100169));

// The network was partitioned before the robots had heard of each other. Each missed its peers one by one,
// and never so many at once that it took its own part for the smaller one.
INSTANTIATE_TEST_SUITE_P(PartitionedFromTheStart, FuzzSeedsWithRestarts, testing::Values(2100149));

// The network was partitioned when an agent had its own mission, and not yet those of the others. It did not
// know that there were others, and drove after the startup.
INSTANTIATE_TEST_SUITE_P(PartitionedBetweenTheMissions, FuzzSeedsWithRestarts, testing::Values(11200066));

// The zones of failed robots left no room for a way past. A robot stood in such a zone, or very slightly too
// close to it.
INSTANTIATE_TEST_SUITE_P(OversizedZones, FuzzSeeds, testing::Values(510042, 510110, 700374, 750035));

// An agent that was just restarted took the loss for the largest possible. The zone of the failed robot
// covered the agent's goal.
INSTANTIATE_TEST_SUITE_P(OversizedZoneAfterARestart, FuzzSeedsWithRestarts, testing::Values(13200061));

// An agent was restarted while its robot stood in a pocket as wide as the robot. Rounding had brought the
// robot closer to a wall than its radius, so the search of all passages found no way out of the pocket.
INSTANTIATE_TEST_SUITE_P(RestartedInAPocketAsWideAsTheRobot, FuzzSeedsWithRestarts, testing::Values(4620102));

// A robot that turned on the spot counted as standing, and spoke at heartbeats only. So its journal held an
// old yaw when its agent was killed.
INSTANTIATE_TEST_SUITE_P(KilledWhileItTurned, FuzzSeedsOfDifferentialRobotsWithRestarts,
                         testing::Values(21000101));

}  // namespace
}  // namespace coppice
