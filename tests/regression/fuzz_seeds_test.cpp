// Cases of `coppice fuzz` that failed once, each with what was wrong. A change of what a seed draws makes
// them other cases: then the case, not the seed, has to be written down.
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

TEST_P(FuzzSeeds, AreSurvived) {
  expect_survived(draw_fuzz_case(GetParam()));
}

class FuzzSeedsWithRestarts : public testing::TestWithParam<std::uint32_t> {};

TEST_P(FuzzSeedsWithRestarts, AreSurvived) {
  expect_survived(draw_fuzz_case(GetParam(), true));
}

INSTANTIATE_TEST_SUITE_P(PastItsOwnGoal, FuzzSeeds,
                         testing::Values(7));  // where one must wait, and come back, while the other passes
INSTANTIATE_TEST_SUITE_P(LastWordsHeardByNobody, FuzzSeeds, testing::Values(100456));
// A robot's velocity jumps at the beginning of a period, not evenly within it.
INSTANTIATE_TEST_SUITE_P(TwoThatCreep, FuzzSeeds, testing::Values(100213));
INSTANTIATE_TEST_SUITE_P(LateCrossing, FuzzSeeds, testing::Values(1100));  // 40 robots, a third of the news
INSTANTIATE_TEST_SUITE_P(MutualFear, FuzzSeeds,
                         testing::Values(1095,  // with 0.24 s delay, robots under orders feared each other's
                                         1155));  // next move for ever: none bound itself to stand for long
// Head-on in a corridor, each took the other, that it had just pushed back, for one that goes its way: they
// let each other go first for ever, and no time in which one stands for that counted as without progress.
INSTANTIATE_TEST_SUITE_P(PushedToAndFro, FuzzSeeds, testing::Values(1000588));

// One fell silent, was heard of again, and died elsewhere while the other was down: that one knew only of the
// silence, and drove into it.
INSTANTIATE_TEST_SUITE_P(DiedUnseen, FuzzSeedsWithRestarts, testing::Values(1100169));

// In pieces before they had heard of each other: each missed the others one by one, and never so many at once
// that it took its own piece for the smaller one.
INSTANTIATE_TEST_SUITE_P(InPiecesFromTheBeginning, FuzzSeedsWithRestarts, testing::Values(2100149));

// More was kept clear around the dead than a way past it had room for; one stood where others feared it, or a
// hair too close to where it might stand.
INSTANTIATE_TEST_SUITE_P(TooMuchKeptClear, FuzzSeeds, testing::Values(510042, 510110, 700374, 750035));

}  // namespace
}  // namespace coppice
