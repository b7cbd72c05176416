#include "simulation/fuzz.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace coppice {
namespace {

FuzzResult run(const FuzzCase& fuzz_case) {
  FleetSimulation simulation(fuzz_case.scenario, fuzz_case.settings);
  simulation.run([](const PlannerService&, double) { return true; });
  return judge(fuzz_case, simulation);
}

void expect_survived(std::uint32_t seed) {
  const FuzzCase fuzz_case = draw_fuzz_case(seed);
  for (const std::string& failure : run(fuzz_case).failures)
    ADD_FAILURE() << "seed " << seed << ": " << fuzz_case.what << ": " << failure;
}

TEST(Fuzz, TheFirstSeedsPass) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) expect_survived(seed);
}

TEST(Fuzz, TheSameSeedGivesTheSameCase) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const FuzzCase a = draw_fuzz_case(seed);
    const FuzzCase b = draw_fuzz_case(seed);
    EXPECT_EQ(a.what, b.what);
    EXPECT_EQ(a.scenario.map, b.scenario.map);
    EXPECT_NE(a.what, draw_fuzz_case(seed + 1).what);
  }
}

TEST(Fuzz, NoRobotFailsWhileItIsAloneOnItsSideOfAPartition) {
  int cuts_with_kills = 0;
  for (std::uint32_t seed = 16300001; seed <= 16300100; ++seed) {
    const auto [number, what, scenario, settings] = draw_fuzz_case(seed);
    if (settings.faults.bus.partitions.empty()) continue;
    const Partition& cut = settings.faults.bus.partitions.front();
    const std::vector<AgentFaults> drawn = draw_faults(settings.faults, scenario, settings.timeout);
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      const auto killed_within = [&](double time) { return time > cut.from && time < cut.until; };
      if (std::ranges::none_of(drawn[k].kills, killed_within)) continue;
      ++cuts_with_kills;
      EXPECT_GT(std::ranges::count(drawn, drawn[k].side, &AgentFaults::side), 1) << what;
    }
  }
  EXPECT_GT(cuts_with_kills, 0);
}

TEST(Fuzz, ARobotThatCouldArriveAndDoesNotIsAFailure) {
  FuzzCase fuzz_case = draw_fuzz_case(1);
  fuzz_case.settings.timeout = 1;  // no robot arrives within 1 s
  EXPECT_FALSE(run(fuzz_case).failures.empty());
}

TEST(Fuzz, ARobotWhoseWayAFailedRobotClosesIsNoFailure) {
  // A corridor 14 m wide: a robot behind the failed one cannot pass it.
  FuzzCase fuzz_case{.scenario = {.map_name = "corridor",
                                  .map = {.width = 200, .height = 14, .blocked = {}},
                                  .robots = {{"a", {30, 7}, {180, 7}, 5, 20, 40, 1},
                                             {"b", {10, 7}, {160, 7}, 5, 20, 40, 1}}},
                     .settings = {.timeout = 60, .faults = {.kills = {{"a", 3}}}}};
  fuzz_case.scenario.map.blocked.assign(200 * 14, 0);
  const FuzzResult result = run(fuzz_case);
  EXPECT_TRUE(result.failures.empty()) << result.failures.front();
  EXPECT_EQ(result.suffered.kills, 1u);
}

}  // namespace
}  // namespace coppice
