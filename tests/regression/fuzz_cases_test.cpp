// Cases of `coppice fuzz` that failed once, each with what was wrong. The scenarios are in fuzz_cases/, under
// the seeds that once drew them.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "coppice/files/scenario_file.h"
#include "simulation/fuzz_judge.h"

namespace coppice {
namespace {

struct KeptCase {
  std::string name;
  std::uint32_t seed;
  SimulationSettings settings;
};

const std::vector<KeptCase>& kept_cases() {
  static const std::vector<KeptCase> cases{
      // One robot must wait past its goal, and come back, while the other passes.
      {"PassingBehindTheGoal",
       7,
       {.plan_budget = 1,
        .lifelong = 300,
        .faults = {.bus = {.loss = 0.2870304513434638,
                           .delay = 0.2409148804703074,
                           .jitter = 0.11219494860385956,
                           .reorder = true,
                           .partitions = {{9.892703228429731, 15.207877350682406}}},
                   .clock_skew = 0.3439362813249549}}},
      // The last states of a robot that failed reached nobody.
      {"LastStatesUnheard",
       100456,
       {.plan_budget = 0.05,
        .lifelong = 300,
        .faults = {.bus = {.loss = 0.15976492304482434,
                           .partitions = {{11.709413451129167, 17.190045869467625}}},
                   .kills = {{"r2", 5.677968665714417}}}}},
      // A velocity jumps at the beginning of a control period. It does not change evenly within it.
      {"TwoCreepingRobots",
       100213,
       {.plan_budget = 0.05,
        .faults = {.bus = {.duplicate = 0.06141084989509802,
                           .partitions = {{18.417786391215934, 31.607068790125517}}},
                   .pause_rate = 58.134614469720326,
                   .pause = 0.21588569251638784,
                   .clock_skew = 1.171344876873065}}},
      // 40 robots, a third of the states lost.
      {"CrossingWithLoss",
       1100,
       {.plan_budget = 0.05,
        .faults = {.bus = {.loss = 0.3742585165517234,
                           .delay = 0.08883336030605954,
                           .jitter = 0.019978031532144933,
                           .cut_links = {{"r31", "r11", 2.3318834841387526, 13.668570541570219}}},
                   .clock_skew = 0.11782867630829008}}},
      // With a delay of 0.24 s, robots that executed a plan avoided each other's next move for ever: none
      // committed to stand for long. So in the next case.
      {"MutualAvoidance",
       1095,
       {.plan_budget = 0.05,
        .lifelong = 300,
        .faults = {.bus = {.delay = 0.23839613094968248,
                           .jitter = 0.0015453641506859548,
                           .duplicate = 0.015763304750039054,
                           .reorder = true,
                           .cut_links = {{"r2", "r5", 0, 49.418090268770655}}},
                   .kills = {{"r5", 11.142994419158638}}}}},
      {"MutualAvoidanceInACorridor",
       1155,
       {.plan_budget = 1,
        .faults = {.bus = {.loss = 0.3531498500299354,
                           .delay = 0.2381706822940454,
                           .jitter = 0.036383345553038224,
                           .duplicate = 0.09798951831086822,
                           .reorder = true,
                           .partitions = {{19.441586381256222, 50.05646410108035}}},
                   .clock_skew = 0.5974267577813834}}},
      // Two robots met head-on in a corridor. Each assumed that the peer that it had just pushed back drove
      // in its own direction. They let each other go first for ever, and the time for which they stood did
      // not count as being without progress.
      {"PushedToAndFro",
       1000588,
       {.plan_budget = 1,
        .lifelong = 300,
        .faults = {.bus = {.reorder = true, .partitions = {{0.24123519780540947, 25.620401480705993}}},
                   .clock_skew = 0.5048983180153577}}},
      // A joint plan led a robot away from its new goal. The robot took the plan's path for its own, and
      // reserved a way of no length again and again.
      {"LedAway",
       8300043,
       {.plan_budget = 0.05,
        .lifelong = 300,
        .faults = {.bus = {.loss = 0.2827415781680535,
                           .delay = 0.0586498357929498,
                           .jitter = 0.05163283053476294,
                           .reorder = true}}}},
      // A robot waited at a gate very close to the end of a leg, and counted as being at the end. So the
      // gate lay behind it, and it drove past another robot that was to go first.
      {"GateAtTheEndOfALeg",
       12700135,
       {.plan_budget = 0.05,
        .faults = {.bus = {.partitions = {{13.4657267515641, 30.033675698789487}}},
                   .pause_rate = 112.87127095755584,
                   .pause = 0.6398257010543069,
                   .kills = {{"r38", 34.56007197864009}}}}},
      // The network was partitioned when some robots had heard of each other and some had not come yet. The
      // first were suspected one by one, the others given up later. So no robot counted all that were in the
      // other part.
      {"PartitionedWhileTheRobotsCome",
       13400004,
       {.plan_budget = 0.05,
        .faults = {.bus = {.reorder = true, .partitions = {{0.28742041267379337, 47.65517982163162}}},
                   .clock_skew = 1.077511270212123}}},
      // The zones of failed robots left no room for a way past. A robot stood in such a zone, or very
      // slightly too close to it. So in the next three cases.
      {"OversizedZone",
       510042,
       {.plan_budget = 0.05,
        .faults = {.bus = {.loss = 0.3321422787184065,
                           .delay = 0.05509296638114933,
                           .jitter = 0.010538223688093906},
                   .pause_rate = 75.10897344848293,
                   .pause = 0.8829387474803907,
                   .kills = {{"r2", 22.91113905225893}}}}},
      {"OversizedZoneInACorridor",
       510110,
       {.plan_budget = 1,
        .faults = {.bus = {.loss = 0.3440163919343501,
                           .delay = 0.24487900097015305,
                           .jitter = 0.16424739494580548,
                           .duplicate = 0.017820291278631783},
                   .clock_skew = 1.717050954728645,
                   .kills = {{"r1", 7.107057954535474}}}}},
      {"OversizedZoneAmongUnlikeRobots",
       700374,
       {.plan_budget = 0.05,
        .faults = {.bus = {.cut_links = {{"r27", "r12", 0, 9.159786323563706},
                                         {"r28", "r13", 0, 73.72015076647385}}},
                   .pause_rate = 119.88763946462032,
                   .pause = 0.2341029943812218,
                   .kills = {{"r17", 3.32083259138515}}}}},
      {"OversizedZoneInAMaze",
       750035,
       {.plan_budget = 0.05,
        .lifelong = 300,
        .faults = {.bus = {.loss = 0.22414010744905385, .duplicate = 0.02327920284392513, .reorder = true},
                   .kills = {{"r6", 2.656209419372031}}}}},
      // A robot fell silent, was heard again, and failed elsewhere while another agent was down. That agent
      // knew only of the silence, and drove into the robot.
      {"FailedUnseen",
       1100169,
       {.plan_budget = 0.05,
        .lifelong = 300,
        .faults = {.bus = {.loss = 0.10377209850874976,
                           .delay = 0.17392109936095657,
                           .jitter = 0.017041664207022276,
                           .duplicate = 0.04333247292287552,
                           .reorder = true,
                           .partitions = {{0.6016233164352469, 48.168107739026496}}},
                   .kill_rate = 91.82753422489861,
                   .pause_rate = 111.57756022855797,
                   .pause = 1.1522866205242928,
                   .kills = {{"r1", 63.596756492582855, true}},
                   .restart_after = 6.092054034546146}}},
      // The network was partitioned before the robots had heard of each other. Each missed its peers one by
      // one, and never so many at once that it took its own part for the smaller one.
      {"PartitionedFromTheStart",
       2100149,
       {.plan_budget = 0.05,
        .faults = {.bus = {.loss = 0.12226688636615557,
                           .delay = 0.22085818882084698,
                           .jitter = 0.13281766228897038,
                           .reorder = true,
                           .partitions = {{0.8096525988951675, 24.83125222489205}}},
                   .kill_rate = 12.367085270482931,
                   .pause_rate = 67.98033435173339,
                   .pause = 0.972460318215644,
                   .restart_after = 3.726341610841398}}},
      // The network was partitioned when an agent had its own mission, and not yet those of the others. It
      // did not know that there were others, and drove after the startup.
      {"PartitionedBetweenTheMissions",
       11200066,
       {.plan_budget = 0.05,
        .faults = {.bus = {.loss = 0.2738533442662732,
                           .duplicate = 0.04538592547261947,
                           .reorder = true,
                           .partitions = {{0.35728031479111744, 49.61817608967624}}},
                   .kill_rate = 74.84151142806977,
                   .pause_rate = 114.57005356920762,
                   .pause = 1.0878983552378887,
                   .clock_skew = 1.1615666524062587,
                   .kills = {{"r3", 61.48032475204616, true}},
                   .restart_after = 4.109320735536259}}},
      // An agent that was just restarted took the loss for the largest possible. The zone of the failed
      // robot covered the agent's goal.
      {"OversizedZoneAfterARestart",
       13200061,
       {.plan_budget = 0.05,
        .lifelong = 300,
        .faults = {.bus = {.reorder = true, .partitions = {{2.740125088806089, 33.54216370865834}}},
                   .kill_rate = 88.38514140203463,
                   .pause_rate = 116.82192528537074,
                   .pause = 0.3511996560989348,
                   .clock_skew = 1.2039561742684748,
                   .kills = {{"r2", 44.137961817107374, true}},
                   .restart_after = 4.704272427374926}}},
      // An agent was restarted while its robot stood in a pocket as wide as the robot. Rounding had brought
      // the robot closer to a wall than its radius, so the search of all passages found no way out of the
      // pocket.
      {"RestartedInAPocketAsWideAsTheRobot",
       4620102,
       {.plan_budget = 0.05,
        .faults = {.bus = {.reorder = true, .partitions = {{9.537984162705042, 20.809677561160914}}},
                   .kill_rate = 94.77665880690347,
                   .clock_skew = 1.3887349278974608,
                   .restart_after = 6.449511137841607}}},
      // A robot that turned on the spot counted as standing, and spoke at heartbeats only. So its journal
      // held an old yaw when its agent was killed.
      {"KilledWhileItTurned",
       21000101,
       {.plan_budget = 0.05,
        .faults = {.bus = {.loss = 0.26051961774379284,
                           .delay = 0.1531612912808973,
                           .jitter = 0.058328792679459375,
                           .duplicate = 0.03411718286143394,
                           .reorder = true},
                   .kill_rate = 163.1160680737627,
                   .restart_after = 0.9247414527823988}}},
      // Clocks were so wrong that some robots came late. In a partition they were alone in hearing a robot
      // that
      // all others took for cut off: it drove on, out of the disc that these kept clear.
      {"HeardByLatecomersAlone",
       49700586,
       {.timeout = 36000,
        .plan_budget = 0.05,
        .lifelong = 233.65775333921803,
        .faults = {.bus = {.loss = 0.17141624032027492,
                           .duplicate = 0.066801026732594207,
                           .reorder = true,
                           .partitions = {{14.679220066587755, 63.826105938073972}}},
                   .pause_rate = 13.978941730713167,
                   .pause = 0.35556873028285996,
                   .clock_skew = 45.907645033186185}}},
  };
  return cases;
}

class FuzzCases : public testing::TestWithParam<KeptCase> {};

TEST_P(FuzzCases, Passes) {
  const KeptCase& kept = GetParam();
  const auto file = std::filesystem::path(COPPICE_SOURCE_DIR) / "tests/regression/fuzz_cases" /
                    (std::to_string(kept.seed) + ".json");
  const FuzzCase fuzz_case{
      .seed = kept.seed, .what = kept.name, .scenario = read_scenario(file, {}), .settings = kept.settings};
  FleetSimulation simulation(fuzz_case.scenario, fuzz_case.settings);
  simulation.run([](const PlannerService&, double) { return true; });
  for (const std::string& failure : judge(fuzz_case, simulation).failures) ADD_FAILURE() << failure;
}

INSTANTIATE_TEST_SUITE_P(Kept, FuzzCases, testing::ValuesIn(kept_cases()),
                         [](const auto& kept) { return kept.param.name; });

}  // namespace
}  // namespace coppice
