// Tests of joint plans of grid planners: both text forms, and the checks against a scenario.
#include "coppice/files/plan_file.h"

#include <string>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "files/text_file.h"
#include "tests/support.h"

namespace coppice {
namespace {

struct PlanFile : testing::Test {
  std::filesystem::path written(const std::string& text) const {
    write_file(folder.path() / "plan.txt", text);
    return folder.path() / "plan.txt";
  }
  std::string error_of(const std::string& text) const {
    try {
      read_grid_plan(written(text));
      return "no error";
    } catch (const InputError& problem) {
      return problem.what();
    }
  }
  TemporaryFolder folder;
};

/// Four by three free cells of 2 m, and two robots that swap along the upper row.
Scenario two_on_a_grid() {
  Scenario scenario;
  scenario.map = {.width = 4,
                  .height = 3,
                  .resolution = 2,
                  .origin = {10, 20},
                  .blocked = std::vector<std::uint8_t>(12, 0)};
  scenario.map.blocked[11] = 1;
  scenario.robots = {{"a", {11, 21}, {17, 21}, 0.6, 1, 2, 0.1}, {"b", {17, 21}, {11, 21}, 0.6, 2, 4, 0.1}};
  return scenario;
}

const GridPlan swap{{{0, 0}, {1, 0}, {2, 0}, {3, 0}}, {{3, 0}, {3, 1}, {2, 1}, {1, 1}, {0, 1}, {0, 0}}};

std::string error_of_plan(const GridPlan& plan, const Scenario& scenario = two_on_a_grid()) {
  try {
    trajectories_of(plan, scenario);
    return "no error";
  } catch (const InputError& problem) {
    return problem.what();
  }
}

TEST_F(PlanFile, ReadsTheStepsThatLacamWrites) {
  const GridPlan plan = read_grid_plan(written(
      "agents=2\nmap_file=a.map\nsoc=3\nsolution=\n0:(0,5),(3,2),\n1:(1,5),(3,2),\n2:(1,6),(3,3),\n"));
  EXPECT_EQ(plan, (GridPlan{{{0, 5}, {1, 5}, {1, 6}}, {{3, 2}, {3, 2}, {3, 3}}}));
}

TEST_F(PlanFile, ReadsTheStepsOfMapfVisualizer) {
  const GridPlan expected{{{0, 5}, {1, 5}, {1, 6}}, {{3, 2}, {3, 2}, {3, 3}}};
  const std::string steps = "0:(0,5),(3,2),\n1:(1,5),(3,2),\n\n2:(1,6),(3,3)\r\n";
  EXPECT_EQ(read_grid_plan(written(steps)), expected) << "no header";
  EXPECT_EQ(read_grid_plan(written("agents=2\n" + steps)), expected) << "no line solution=";
  EXPECT_EQ(read_grid_plan(written("0:(0,5,Y_MINUS),(3,2,X_MINUS),\n1:(1,5,X_PLUS),(3,2,Y_PLUS),\n"
                                   "2:(1,6, Y_PLUS),(3,3),\n")),
            expected)
      << "headings";
}

TEST_F(PlanFile, ReadsTheAgentsThatCbsWrites) {
  const GridPlan plan =
      read_grid_plan(written("Agent 0: (5,0)->(5,1)->(6,1)->\r\n\nAgent 1: (2,3)->(2,3)->(3,3)\n"));
  EXPECT_EQ(plan, (GridPlan{{{0, 5}, {1, 5}, {1, 6}}, {{3, 2}, {3, 2}, {3, 3}}}));
}

TEST_F(PlanFile, ReadsWhatItWrites) {
  for (const GridPlanForm form : {GridPlanForm::agents, GridPlanForm::steps}) {
    write_grid_plan(folder.path() / "plan", swap, form);
    GridPlan expected = swap;
    if (form == GridPlanForm::steps) expected[0].resize(6, {3, 0});  // each step has a cell for each robot
    EXPECT_EQ(read_grid_plan(folder.path() / "plan"), expected);
  }
}

TEST_F(PlanFile, AnErrorNamesTheLineAndWhatWasExpected) {
  const auto expect = [&](const std::string& text, const std::string& error) {
    EXPECT_EQ(error_of(text), (folder.path() / "plan.txt").string() + error);
  };
  expect("hello",
         ":1: expected \"0:(x,y),...\", \"Agent N: (row,column)->...\", or KEY=VALUE before \"solution=\"");
  expect("agents=2\n", ": has no plan, expected \"0:(x,y),...\" or \"Agent 0: ...\"");
  expect("solution=\n", ": has no plan, expected \"0:(x,y),...\" or \"Agent 0: ...\"");
  expect("solution=\n0:\n", ":2: has 0 cells, expected 1");
  expect("solution=\n1:(0,0),\n", ":2: expected \"0:(x,y),(x,y),...\"");
  expect("solution=\n0:(0,0),(1,1),\n1:(0,0),\n", ":3: has 1 cells, expected 2");
  const std::string a_cell =
      "expected \"(x,y)\" or \"(x,y,HEADING)\" with X_PLUS, X_MINUS, Y_PLUS or Y_MINUS";
  expect("solution=\n0:(0,0),(1,x),\n", ":2: robot 1: " + a_cell);
  expect("0:(0,0,NORTH),\n", ":1: robot 0: " + a_cell);
  expect("0:(0,0,X_PLUS,1),\n", ":1: robot 0: " + a_cell);
  expect("1:(0,0),\n", ":1: expected \"0:(x,y),(x,y),...\"");
  expect("0:(0,0),\nsolution=\n", ":2: expected \"1:(x,y),(x,y),...\"");
  expect("solution=\n0:(0,0)(1,1)\n", ":2: robot 1: expected \",\"");
  expect("solution=\n0:(0,99999999999)\n", ":2: robot 0: " + a_cell);
  expect("Agent 1: (0,0)\n", ":1: expected \"Agent 0: (row,column)->(row,column)->...\"");
  expect("Agent 0: (0,0)->(0;1)\n", ":1: step 1: expected \"(row,column)\"");
  expect("Agent 0: (0,0) (0,1)\n", ":1: step 1: expected \"->\"");
  expect("Agent 0: (0,0)\nsolution=\n0:(0,0)\n",
         ":3: expected \"0:(x,y),...\", \"Agent N: (row,column)->...\", or KEY=VALUE before \"solution=\"");
  expect("solution=\n0:(0,0)\nAgent 0: (0,0)\n", ":3: expected \"1:(x,y),...\"");
  expect("version 1\n0 a.map 1 1 0 0 0 0 0\n",
         ": is a Moving AI scenario, expected a joint plan (\"0:(x,y),...\" or \"Agent 0: "
         "(row,column)->...\"): coppice run, simulate and plan take it");
  expect("",
         ": is empty, expected a joint plan (\"0:(x,y),...\" or \"Agent 0: "
         "(row,column)->...\")");
}

// The slower robot takes 2 s for a cell.
TEST_F(PlanFile, AStepTakesAsLongAsTheSlowestRobotTakesForACell) {
  const std::vector<Trajectory> trajectories = trajectories_of(swap, two_on_a_grid());
  EXPECT_EQ(trajectories.at(0), (Trajectory{{0, {11, 21}}, {6, {17, 21}}}));
  EXPECT_EQ(trajectories.at(1), (Trajectory{{0, {17, 21}}, {2, {17, 23}}, {8, {11, 23}}, {10, {11, 21}}}));
  EXPECT_EQ(trajectories_of({{{0, 0}, {0, 0}, {1, 0}, {2, 0}, {3, 0}}, swap[1]}, two_on_a_grid()).at(0),
            (Trajectory{{0, {11, 21}}, {2, {11, 21}}, {8, {17, 21}}}));
}

TEST_F(PlanFile, APlanOfAnotherScenarioIsRefused) {
  EXPECT_EQ(error_of_plan({swap[0]}), "the plan is for 1 robots, expected 2");
  EXPECT_EQ(error_of_plan({swap[1], swap[0]}),
            "the plan: a begins at (3,0), whose centre is not its start (11, 21)");
  EXPECT_EQ(error_of_plan({swap[0], {{3, 0}}}),
            "the plan: b ends at (3,0), whose centre is not its goal (11, 21)");
  EXPECT_EQ(error_of_plan({{{0, 0}, {1, 1}}, swap[1]}),
            "the plan: a steps from (0,0) to (1,1) at step 1, expected a neighbouring cell or the same");
  EXPECT_EQ(error_of_plan({swap[0], {{3, 0}, {3, 1}, {3, 2}}}),
            "the plan: b is at (3,2) at step 2, which is blocked or not on the map");
  EXPECT_EQ(error_of_plan({swap[0], {{3, 0}, {4, 0}}}),
            "the plan: b is at (4,0) at step 1, which is blocked or not on the map");
  EXPECT_EQ(error_of_plan({swap[0], {}}), "the plan: b has no cell");
}

TEST_F(PlanFile, APlanInWhichSomethingTouchesIsRefused) {
  const GridPlan head_on{swap[0], {{3, 0}, {2, 0}, {1, 0}, {0, 0}}};
  EXPECT_EQ(error_of_plan(head_on), "the plan: a and b touch after step 1, radii 0.6 and 0.6");
  const GridPlan last_step{{{0, 0}, {1, 0}, {2, 0}, {3, 0}},
                           {{3, 0}, {3, 1}, {2, 1}, {1, 1}, {0, 1}, {0, 1}, {0, 0}}};
  EXPECT_EQ(error_of_plan(last_step), "no error");
  Scenario wide = two_on_a_grid();
  wide.robots[1].radius = 1.1;
  EXPECT_EQ(error_of_plan(swap, wide), "the plan: b touches an obstacle, radius 1.1");
}

}  // namespace
}  // namespace coppice
