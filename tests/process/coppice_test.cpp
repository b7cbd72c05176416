// Tests of the commands that need no fleet of processes, as a user types them. The command run is in
// fleet_test.cpp.
//
// CTest: PARALLEL

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bench/trial.h"
#include "coppice/files/scenario_file.h"
#include "coppice/files/scenario_generator.h"
#include "coppice/planning/clearance_field.h"
#include "coppice/planning/map_generator.h"
#include "files/report_file.h"
#include "tests/support.h"

namespace coppice {
namespace {

using test::Outcome;
using test::program;
using test::shell;
using test::TemporaryFolder;

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// Checks against the cells of the map that paths begin and end where they should, and keep clear.
void expect_sound_paths(const Scenario& scenario, const proto::Report& report) {
  const ClearanceField field(scenario.map);
  ASSERT_EQ(report.robots_size(), static_cast<int>(scenario.robots.size()));
  for (int i = 0; i < report.robots_size(); ++i) {
    const RobotTask& task = scenario.robots[static_cast<std::size_t>(i)];
    const auto& row = report.robots(i);
    EXPECT_TRUE(row.planned()) << row.name() << ": " << row.reason();
    Path path;
    for (const auto& p : row.path()) path.emplace_back(p.x(), p.y());
    ASSERT_GE(path.size(), 2u);
    EXPECT_EQ(path.front(), task.start);
    EXPECT_EQ(path.back(), task.goal);
    EXPECT_NEAR(length_of(path), row.path_length(), 1e-6);
    for (std::size_t k = 1; k < path.size(); ++k)
      EXPECT_TRUE(field.segment_free(path[k - 1], path[k], task.radius));
  }
}

TEST(CoppicePlan, ThePlannerPlansTheSharedMaps) {
  const std::filesystem::path maps = std::filesystem::path(COPPICE_SHARED_DIR) / "maps";
  if (!std::filesystem::exists(maps)) GTEST_SKIP() << "the shared maps are not here";
  const TemporaryFolder folder;
  for (const char* name : {"room1-10.scen", "maze1-5.scen", "maze1-20.scen"}) {
    const std::string report_file = folder.path() / "report.json";
    const Outcome outcome =
        shell(program("coppice") + " plan " + (maps / name).string() + " --radius 3 --report " + report_file);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    const proto::Report report = read_report(report_file);
    expect_sound_paths(read_scenario(maps / name, {.radius = 3}), report);
    EXPECT_GT(report.trees_grafted(), 0u);
  }
}

TEST(CoppicePlan, EveryPlannerFindsValidPaths) {
  const TemporaryFolder folder;
  const std::filesystem::path scenario = test::scenarios() / "rooms-8.json";
  for (const char* planner : {"ma-rrdt", "rrdt", "rrt-star"}) {
    const std::string report_file = folder.path() / "report.json";
    const Outcome outcome = shell(program("coppice") + " plan " + scenario.string() +
                                  " --plan-budget 0 --planner " + planner + " --report " + report_file);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    expect_sound_paths(read_scenario(scenario, {}), read_report(report_file));
  }
  EXPECT_EQ(shell(program("coppice") + " plan " + scenario.string() + " --planner prm").exit_code, 2);
}

TEST(CoppicePlan, ABudgetGivesShorterPaths) {
  const TemporaryFolder folder;
  const auto length = [&](const std::string& options) {
    const std::string report_file = folder.path() / "report.json";
    const std::string scenario = (test::scenarios() / "dense-8.json").string();
    EXPECT_EQ(
        shell(program("coppice") + " plan " + scenario + options + " --report " + report_file).exit_code, 0);
    return read_report(report_file).path_length();
  };
  EXPECT_LT(length(""), 0.97 * length(" --plan-budget 0"));
}

TEST(CoppiceBench, QuickExperimentsWriteTablesAndPlots) {
  const TemporaryFolder folder;
  for (const std::string experiment : {"paper", "lifelong"}) {
    const Outcome outcome =
        shell(program("coppice") + " bench " + experiment +
              " --quick --maps room --robots 3 --seeds 2 --output " + folder.path().string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    const std::string csv = test::contents(folder.path() / (experiment + ".csv"));
    EXPECT_EQ(count(csv, "\n"), experiment == "paper" ? 1 + 2 * 3 : 1 + 2 * 10) << csv;
    EXPECT_NE(test::contents(folder.path() / (experiment + ".md")).find("| room"), std::string::npos);
    EXPECT_NE(test::contents(folder.path() / (experiment + ".svg")).find("<polyline"), std::string::npos);
  }
  EXPECT_EQ(shell(program("coppice") + " bench nothing").exit_code, 2);
  EXPECT_EQ(shell(program("coppice") + " bench paper --output /no/such/folder").exit_code, 2);
}

/// The bench measures what `coppice simulate` with the same seed reports.
TEST(CoppiceBench, ThroughputMeasuresArrivalsAndWaits) {
  TemporaryFolder folder;
  folder.write("figures.csv", "scenario,planner,sum,last,goals_per_second\nrooms-8,Half,10,5,0.1\n");
  const auto file = [&](const std::string& name) { return (folder.path() / name).string(); };
  const std::string scenario = (test::scenarios() / "rooms-8.json").string();
  const std::string bench = program("coppice") + " bench throughput --scenarios " + scenario +
                            " --seed 3 --output " + folder.path().string() + " --references " +
                            file("figures.csv");
  const Outcome outcome = shell(bench + " --seeds 2");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const std::string csv = test::contents(file("throughput.csv"));
  ASSERT_EQ(count(csv, "\n"), 3) << csv;

  ASSERT_EQ(
      shell(program("coppice") + " simulate " + scenario + " --seed 3 --quiet --report " + file("r.json"))
          .exit_code,
      0);
  const proto::Report report = read_report(file("r.json"));
  double sum = 0;
  double free_flow = 0;
  for (const auto& robot : report.robots()) {
    sum += robot.run_time();
    free_flow += robot.free_flow_time();
    EXPECT_GT(robot.free_flow_time(), 1);
    EXPECT_LT(robot.free_flow_time(), robot.run_time());
    EXPECT_NEAR(robot.waited(),
                robot.waits().startup() + robot.waits().planning() + robot.waits().reservation() +
                    robot.waits().joint_plan() + robot.waits().gate() + robot.waits().promise() +
                    robot.waits().connection() + robot.waits().odometry(),
                1e-6);
    EXPECT_LE(robot.waited(), robot.run_time());
  }
  EXPECT_NE(csv.find(fmt::format("rooms-8,8,3,8,0,{:.3f},{:.3f},", sum, report.run_time())),
            std::string::npos)
      << csv << sum << ' ' << report.run_time();
  EXPECT_NE(csv.find(fmt::format(",{:.3f},", free_flow)), std::string::npos) << csv << free_flow;
  const std::string table = test::contents(file("throughput.md"));
  EXPECT_NE(table.find("| 2 of 2 "), std::string::npos) << table;
  EXPECT_NE(table.find("| Half "), std::string::npos) << table;
  EXPECT_NE(test::contents(file("throughput.svg")).find("<polyline"), std::string::npos);

  const Outcome lifelong = shell(bench + " --lifelong 30");
  EXPECT_EQ(lifelong.exit_code, 0) << lifelong.output;
  EXPECT_NE(lifelong.output.find("goals per second"), std::string::npos) << lifelong.output;
}

TEST(CoppiceBench, ThroughputRefusesBadInput) {
  const std::string bench = program("coppice") + " bench throughput";
  const Outcome none = shell(bench);
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.output.find("--scenarios"), std::string::npos) << none.output;
  EXPECT_EQ(shell(bench + " --scenarios /no/such.json").exit_code, 2);
  const std::string scenario = (test::scenarios() / "rooms-8.json").string();
  EXPECT_EQ(shell(bench + " --scenarios " + scenario + " --references " + scenario).exit_code, 2);
}

TEST(CoppiceFuzz, TheFuzzerReportsRobotHoursAndReplaysACase) {
  const TemporaryFolder folder;
  const Outcome outcome = shell(program("coppice") + " fuzz --hours 0.05 --seed 3");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("robot-hours"), std::string::npos) << outcome.output;
  EXPECT_NE(outcome.output.find("decisions checked"), std::string::npos) << outcome.output;
  const std::string trajectory = (folder.path() / "t.csv").string();
  EXPECT_EQ(shell(program("coppice") + " fuzz --replay 3 --trajectory " + trajectory).exit_code, 0);
  EXPECT_NE(test::contents(trajectory).find("time,robot,x,y,vx,vy,yaw,omega"), std::string::npos);
}

TEST(CoppiceBench, TheBenchmarkTakesMapsFromFiles) {
  const TemporaryFolder folder;
  const std::string map = (folder.path() / "yard.map").string();
  ASSERT_EQ(shell(program("coppice") + " map room " + (folder.path() / "yard.json").string() +
                  " --width 200 --height 200 --seed 3")
                .exit_code,
            0);
  const Outcome outcome = shell(program("coppice") + " bench lifelong --maps " + map +
                                " --robots 3 --seeds 1 --output " + folder.path().string());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NE(test::contents(folder.path() / "lifelong.md").find("| yard"), std::string::npos);
  EXPECT_EQ(shell(program("coppice") + " bench lifelong --maps /no/such.map").exit_code, 2);
  const Outcome fleets = shell(program("coppice") + " bench sharing --maps " + map +
                               " --robots 2 --seeds 1 --output " + folder.path().string());
  EXPECT_EQ(fleets.exit_code, 0) << fleets.output;
  const Outcome scale = shell(program("coppice") + " bench scale --maps " + map);
  EXPECT_EQ(scale.exit_code, 2);
  EXPECT_NE(scale.output.find("--maps"), std::string::npos) << scale.output;

  const std::string scenario = (folder.path() / "tasks.json").string();
  EXPECT_EQ(shell(program("coppice") + " map " + map + " " + scenario).exit_code, 0);
  EXPECT_NE(test::contents(scenario).find("\"yard.map\""), std::string::npos);
  EXPECT_EQ(shell(program("coppice") + " plan " + scenario).exit_code, 0);
}

// Results of maps that can be measured are printed and kept, also those of the map that fails for many
// robots.
TEST(CoppiceBench, TheBenchmarkKeepsItsResultsIfAMapFails) {
  const TemporaryFolder folder;
  const auto open_map = [&](const std::string& name, int side) {
    std::string text = fmt::format("type octile\nheight {0}\nwidth {0}\nmap\n", side);
    for (int j = 0; j < side; ++j) text += std::string(static_cast<std::size_t>(side), '.') + '\n';
    folder.write(name, text);
  };
  open_map("wide.map", 20);
  open_map("small.map", 3);
  for (const std::string experiment : {"paper", "peers", "lifelong", "avoidance", "sharing"}) {
    if (experiment == "peers" && !built_with_ompl()) continue;
    const std::string to = (folder.path() / experiment).string();
    std::filesystem::create_directory(to);
    const Outcome outcome =
        shell("cd " + folder.path().string() + " && " + program("coppice") + " bench " + experiment +
              " --maps small.map,wide.map --robots 1,10 --radius 0.4 --seeds 1 --output " + to);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    EXPECT_NE(outcome.output.find("small.map, 10 robots: "), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("room for 9 robots of radius 0.4"), std::string::npos) << outcome.output;
    for (const std::string& text : {outcome.output, test::contents(to + "/" + experiment + ".md")}) {
      EXPECT_NE(text.find("| small | 1 "), std::string::npos) << experiment << text;
      EXPECT_EQ(text.find("| small | 10 "), std::string::npos) << experiment << text;
      EXPECT_NE(text.find("| wide "), std::string::npos) << experiment << text;
    }
    EXPECT_NE(test::contents(to + "/" + experiment + ".csv").find("small,1,1,"), std::string::npos);
    EXPECT_NE(test::contents(to + "/" + experiment + ".csv").find("wide,10,1,"), std::string::npos);
  }
}

TEST(CoppiceBench, TheBenchmarkEndsIfNothingCanBeMeasured) {
  const TemporaryFolder folder;
  folder.write("small.map", "type octile\nheight 1\nwidth 4\nmap\n....\n");
#ifdef __SANITIZE_ADDRESS__
  const std::string within = "timeout 60 ";  // the sanitizer reserves terabytes of addresses
#else
  const std::string within = "ulimit -v 4000000 && timeout 60 ";
#endif
  const Outcome outcome = shell("cd " + folder.path().string() + " && " + within + program("coppice") +
                                " bench lifelong --maps small.map --robots 10 --radius 0.4 --seeds 1");
  EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
  EXPECT_NE(test::contents(folder.path() / "lifelong.svg").find("</svg>"), std::string::npos);
}

TEST(CoppiceMap, TasksAreDrawnThroughDoorsOfOneCellUpToTheNumberThatFits) {
  const TemporaryFolder folder;
  folder.write(
      "rooms.map",
      "type octile\nheight 5\nwidth 9\nmap\n@@@@@@@@@\n@...@...@\n@.......@\n@...@...@\n@@@@@@@@@\n");
  const std::string at = "cd " + folder.path().string() + " && " + program("coppice") + " map ";
  for (const std::string robots : {"1", "19"}) {
    for (const std::string radius : {"0.3", "0.49"}) {
      const Outcome outcome = shell(at + "rooms.map s.json --robots " + robots + " --radius " + radius);
      EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
      EXPECT_EQ(read_scenario(folder.path() / "s.json", {}).robots.size(), std::stoul(robots));
    }
  }
  const Outcome many = shell(at + "rooms.map s.json --robots 20 --radius 0.4");
  EXPECT_EQ(many.exit_code, 2);
  EXPECT_NE(many.output.find("rooms.map: room for 19 robots of radius 0.4 was found on the map, not for 20"),
            std::string::npos)
      << many.output;
  const Outcome large = shell(at + "rooms.map s.json --robots 1");
  EXPECT_EQ(large.exit_code, 2);
  EXPECT_NE(
      large.output.find("no robot of radius 5 fits on the map: the widest place is for one of about 1.5"),
      std::string::npos)
      << large.output;
}

// The default radius is five cells: 0.25 m on a map with cells of 5 cm.
TEST(CoppiceMap, TheDefaultsAreCountedInCells) {
  const TemporaryFolder folder;
  folder.write("a.pgm", "P5 80 60 255\n" + std::string(80 * 60, static_cast<char>(254)));
  folder.write("a.yaml",
               "image: a.pgm\nresolution: 0.05\norigin: [-2, -1, 0]\nnegate: 0\n"
               "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  const std::string at = "cd " + folder.path().string() + " && " + program("coppice") + " map a.yaml s.json ";
  EXPECT_EQ(shell(at + "--robots 2").exit_code, 0);
  const RobotTask robot = read_scenario(folder.path() / "s.json", {}).robots[0];
  EXPECT_DOUBLE_EQ(robot.radius, 0.25);
  EXPECT_DOUBLE_EQ(robot.max_speed, 1);
  EXPECT_DOUBLE_EQ(robot.goal_tolerance, 0.05);
  EXPECT_EQ(shell(at + "--robots 2 --radius 0.2 --max-speed 0.5").exit_code, 0);
  const RobotTask asked = read_scenario(folder.path() / "s.json", {}).robots[0];
  EXPECT_DOUBLE_EQ(asked.radius, 0.2);
  EXPECT_DOUBLE_EQ(asked.max_speed, 0.5);
  EXPECT_DOUBLE_EQ(asked.goal_tolerance, 0.05);
}

TEST(CoppiceMap, EveryKindOfMapHasTheGivenSizeAndNoScenarioHasItsName) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "m.json").string();
  for (const std::string kind : {"blank", "dense", "maze", "room"}) {
    const Outcome outcome =
        shell(program("coppice") + " map " + kind + " " + file + " --width 160 --height 200 --robots 2");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("160 x 200 cells"), std::string::npos) << outcome.output;
  }
  const std::string help = shell(program("coppice") + " map --help").output;
  for (const ScenarioKind& kind : scenario_kinds()) {
    EXPECT_FALSE(map_kind(kind.name)) << kind.name;
    EXPECT_NE(help.find("\n  " + kind.name + " "), std::string::npos) << kind.name << help;
  }
  EXPECT_EQ(shell(program("coppice") + " map maze-traffic " + file + " --width 160").exit_code, 2);
  EXPECT_EQ(shell(program("coppice") + " map maze " + file + " --width 0").exit_code, 2);
  // Older documents call the kind so.
  const Outcome rooms = shell(program("coppice") + " map rooms " + file + " --robots 3");
  EXPECT_EQ(rooms.exit_code, 0) << rooms.output;
}

// The name of a kind means that kind, and the map beside a scenario belongs to the scenario.
TEST(Coppice, TheMapCommandOverwritesNoForeignFile) {
  const TemporaryFolder folder;
  const std::string at = "cd " + folder.path().string() + " && " + program("coppice") + " map ";
  folder.write("rooms", "no map");
  EXPECT_EQ(shell(at + "rooms mine.json").exit_code, 0);
  EXPECT_NE(test::contents(folder.path() / "mine.json").find("\"mine.map\""), std::string::npos);
  EXPECT_EQ(shell(at + "rooms mine.json").exit_code, 0);
  folder.write("site.map", "somebody's");
  const Outcome outcome = shell(at + "room site.json");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.output.find("site.map: already exists"), std::string::npos) << outcome.output;
  EXPECT_EQ(test::contents(folder.path() / "site.map"), "somebody's");
}

TEST(Coppice, BadUsageAndBadInputAreOneLineAndExitCode2) {
  const TemporaryFolder folder;
  folder.write("small.map", "type octile\nheight 2\nwidth 40\nmap\n" + std::string(40, '.') + "\n");
  const std::string truncated = folder.write(
      "a.json",
      R"({"map": "small.map", "robots": [{"name": "a", "start": {"x":1,"y":1}, "goal": {"x":3,"y":1}}]})");
  const std::string rooms = test::scenarios() / "rooms-8.json";
  for (const std::string command : {"run", "simulate", "plan"}) {
    for (const std::string& arguments :
         {std::string("none.json"), truncated, rooms + " --radius -1", rooms + " --robots 9",
          rooms + " --time-scale 0", rooms + " --max-speed nan", rooms + " --discovery nonsense",
          rooms + " --fancy", std::string()}) {
      const Outcome outcome = shell(program("coppice") + " " + command + " " + arguments);
      EXPECT_EQ(outcome.exit_code, 2) << command << " " << arguments << ": " << outcome.output;
      EXPECT_FALSE(outcome.output.empty());
      EXPECT_LE(count(outcome.output, "\n"), 2) << outcome.output;
    }
  }
  EXPECT_EQ(shell(program("coppice")).exit_code, 2);
  EXPECT_EQ(shell(program("coppice") + " --version").exit_code, 0);
}

TEST(CoppiceSimulate, TheQuietOptionPrintsNothing) {
  const std::string command =
      program("coppice") + " simulate " + (test::scenarios() / "rooms-8.json").string();
  const Outcome quiet = shell(command + " --quiet");
  EXPECT_EQ(quiet.exit_code, 0);
  EXPECT_EQ(quiet.output, "");
  EXPECT_NE(shell(command).output.find("arrived 8/8"), std::string::npos);
}

TEST(CoppiceSimulate, TheSameSeedWritesTheSameBytes) {
  const TemporaryFolder folder;
  const auto simulate = [&](const std::string& name) {
    return shell(program("coppice") + " simulate " + (test::scenarios() / "rooms-8.json").string() +
                 " --seed 5 --report " + (folder.path() / (name + ".json")).string() + " --trajectory " +
                 (folder.path() / (name + ".csv")).string());
  };
  simulate("one");
  simulate("two");
  EXPECT_FALSE(test::contents(folder.path() / "one.csv").empty());
  EXPECT_EQ(test::contents(folder.path() / "one.json"), test::contents(folder.path() / "two.json"));
  EXPECT_EQ(test::contents(folder.path() / "one.csv"), test::contents(folder.path() / "two.csv"));
}

}  // namespace
}  // namespace coppice
