// Tests of `coppice run --plan`: processes carry out a joint plan that was made elsewhere.
//
// CTest: PARALLEL

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "files/text_file.h"
#include "tests/run_check.h"
#include "tests/support.h"

namespace coppice {
namespace {

/// Two corridors, one cell wide, that cross at cell (3, 3).
struct GivenPlanOfProcesses : testing::Test {
  GivenPlanOfProcesses() {
    write_file(file("cross.map"),
               "type octile\nheight 7\nwidth "
               "7\nmap\n@@@.@@@\n@@@.@@@\n@@@.@@@\n.......\n@@@.@@@\n@@@.@@@\n@@@.@@@\n");
    write_file(
        file("cross.scen"),
        "version 1\n0 cross.map 7 7 2 3 6 3 4\n0 cross.map 7 7 1 3 5 3 4\n0 cross.map 7 7 3 1 3 5 4\n");
  }
  std::filesystem::path file(const std::string& name) const { return folder.path() / name; }
  test::Outcome run(const std::string& plan) const {
    write_file(file("plan.txt"), plan);
    return test::shell("'" + test::program("coppice") + "' run '" + file("cross.scen").string() +
                       "' --radius 0.3 --max-speed 1 --time-scale 4 --quiet --trajectory '" +
                       file("t.csv").string() + "' --plan '" + file("plan.txt").string() + "' 2>&1");
  }
  /// When a robot first comes to the middle.
  double time_at_middle(const std::string& robot) const {
    for (const test::Sample& sample : test::read_trajectory_rows(file("t.csv")).at(robot)) {
      if (std::hypot(sample.place.x - 3.5, sample.place.y - 3.5) < 0.2) return sample.time;
    }
    return -1;
  }
  TemporaryFolder folder;
};

// By itself, r1 would pass first: it is the nearest to the crossing.
TEST_F(GivenPlanOfProcesses, RobotsPassInTheOrderOfThePlan) {
  const test::Outcome outcome =
      run("Agent 0: (3,2)->(3,2)->(3,2)->(3,2)->(3,3)->(3,4)->(3,5)->(3,6)->\n"
          "Agent 1: (3,1)->(3,1)->(3,1)->(3,1)->(3,1)->(3,2)->(3,3)->(3,4)->(3,5)->\n"
          "Agent 2: (1,3)->(2,3)->(3,3)->(4,3)->(5,3)->\n");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_GT(time_at_middle("r3"), 0);
  EXPECT_LT(time_at_middle("r3"), time_at_middle("r1"));
  EXPECT_LT(time_at_middle("r1"), time_at_middle("r2"));
}

TEST_F(GivenPlanOfProcesses, AnotherPlanIsAnErrorBeforeAnythingStarts) {
  const test::Outcome outcome = run("Agent 0: (3,2)->(3,3)\nAgent 1: (3,1)\n");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.output, file("plan.txt").string() + ": the plan is for 2 robots, expected 3\n");
  EXPECT_FALSE(std::filesystem::exists(file("t.csv")));
}

}  // namespace
}  // namespace coppice
