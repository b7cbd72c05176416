// Tests that files are read and written alike whatever C++ locale the program has set: a desktop program sets
// the user's.

#include <locale>
#include <string>

#include <gtest/gtest.h>

#include "coppice/files/input_error.h"
#include "coppice/files/map_file.h"
#include "coppice/files/plan_file.h"
#include "coppice/files/scenario_file.h"
#include "coppice/planning/plan_paths.h"
#include "tests/support.h"

namespace coppice {
namespace {

/// Numbers as in Germany, without a need for that locale on this machine: 1.234,5.
struct GermanNumbers : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

struct ProgramsLocale : testing::Test {
  // NOLINTNEXTLINE(cppcoreguidelines-owning-memory): the locale owns its facet
  ProgramsLocale() : before(std::locale::global(std::locale(std::locale(), new GermanNumbers))) {}
  ~ProgramsLocale() override { std::locale::global(before); }

  std::locale before;
  test::TemporaryFolder folder;
};

TEST_F(ProgramsLocale, AMapOfRosIsReadAlike) {
  folder.write("floor.pgm", "P2\n4 3\n255\n0 0 0 0\n0 254 254 0\n0 0 0 0\n");
  const OccupancyMap map = read_map(folder.write(
      "floor.yaml",
      "image: floor.pgm\nresolution: 0.05\norigin: [-1.5, -0.25, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.196\n"));
  EXPECT_EQ(map.resolution, 0.05);
  EXPECT_EQ(map.origin, Point2(-1.5, -0.25));
  EXPECT_FALSE(map.is_blocked(1, 1));
  EXPECT_TRUE(map.is_blocked(0, 1));
}

/// A corridor of 1,200 cells, so that numbers have digits to be grouped.
OccupancyMap corridor() {
  return {.width = 1200, .height = 1, .resolution = 1, .blocked = std::vector<std::uint8_t>(1200, 0)};
}

TEST_F(ProgramsLocale, AMapOfMovingAiIsWrittenAndReadAlike) {
  write_map(folder.path() / "corridor.map", corridor());
  EXPECT_TRUE(
      test::contents(folder.path() / "corridor.map").starts_with("type octile\nheight 1\nwidth 1200\n"));
  EXPECT_EQ(read_map(folder.path() / "corridor.map"), corridor());
}

TEST_F(ProgramsLocale, ScenariosAreWrittenAndReadAlike) {
  write_map(folder.path() / "corridor.map", corridor());
  const auto scen =
      folder.write("corridor.scen", "version 1\n0\tcorridor.map\t1200\t1\t0\t0\t1100\t0\t1100.5\n");
  const Scenario read = read_scenario(scen, {.radius = 0.25, .max_speed = 1.5});
  EXPECT_EQ(read.robots.at(0).goal, Point2(1100.5, 0.5));
  write_scenario(folder.path() / "corridor.json", read);
  const Scenario again = read_scenario(folder.path() / "corridor.json", {});
  EXPECT_EQ(again.robots.at(0).goal, Point2(1100.5, 0.5));
  EXPECT_EQ(again.robots.at(0).radius, 0.25);
  EXPECT_EQ(again.robots.at(0).max_speed, 1.5);
}

TEST_F(ProgramsLocale, PlansAreWrittenAndReadAlike) {
  GridPlan plan(1);
  for (int x = 0; x < 1100; ++x) plan[0].push_back({x, 0});
  for (const GridPlanForm form : {GridPlanForm::agents, GridPlanForm::steps}) {
    write_grid_plan(folder.path() / "plan.txt", plan, form);
    EXPECT_EQ(read_grid_plan(folder.path() / "plan.txt"), plan);
  }
}

TEST_F(ProgramsLocale, MessagesAreAlike) {
  const ClearanceField field(corridor());
  const std::vector<PlanningProblem> problems{{.start = {1150.5, 0.25}, .goal = {5, 0.5}, .radius = 0.4}};
  const auto fault = first_fault(field, problems);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->what,
            "(1150.5, 0.25) is inside of an obstacle or too near to one: clearance 0.25, radius 0.4");
}

}  // namespace
}  // namespace coppice
