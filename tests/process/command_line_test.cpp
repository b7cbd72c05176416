// Tests of bad usage and bad input of the real programs: exit code 2 and an error that names the place,
// before anything starts.
//
// CTest: PARALLEL

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support.h"

namespace coppice {
namespace {

std::string coppice(const std::string& arguments) {
  return "'" + test::program("coppice") + "' " + arguments;
}
std::string rooms() {
  return "'" + (test::scenarios() / "rooms-8.json").string() + "'";
}
std::string rooms_map() {
  return "'" + (test::scenarios() / "rooms-8.map").string() + "'";
}

TEST(CommandLine, BadUsageIsReportedWithTheNameOfTheOption) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "subcommand"},
      {"fly", "subcommand"},
      {"run", "scenario"},
      {"run " + rooms() + " --bogus", "--bogus"},
      {"run " + rooms() + " --robots x", "--robots"},
      {"run " + rooms() + " --robots 0", "--robots"},
      {"run " + rooms() + " --radius -1", "--radius"},
      {"run " + rooms() + " --radius nan", "--radius"},
      {"simulate " + rooms() + " --max-speed 0", "--max-speed"},
      {"run " + rooms() + " --time-scale inf", "--time-scale"},
      {"plan " + rooms() + " --seed -3", "--seed"},
      {"run " + rooms() + " --domain 233", "--domain"},
      {"map castle out.json", "castle"},
      {"map rooms out.json --width 900", "--width"},
      {"map rooms out.json --robots 4097", "--robots"},
      {"map rooms out.json --max-speed 9", "--max-speed"},
      {"map " + rooms_map() + " out.json --height 900", "--height"},
  };
  for (const auto& [arguments, named] : cases) {
    const test::Outcome outcome = test::shell(coppice(arguments));
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_NE(outcome.output.find(named), std::string::npos) << arguments << ": " << outcome.output;
  }
}

/// A scenario of two robots on a map of 40 x 20 free cells, with one change.
struct BadInput {
  std::string name;
  std::string scenario;
  std::string named;  ///< what the error must contain
};

std::string free_map(int rows) {
  std::string map = "type octile\nheight 20\nwidth 40\nmap\n";
  for (int row = 0; row < rows; ++row)
    map += (row == 10 ? std::string(10, '@') : std::string(10, '.')) + std::string(30, '.') + "\n";
  return map;
}

std::string scenario(const std::string& map, const std::string& first_start,
                     const std::string& more = R"("radius": 1, )") {
  return R"({"map": ")" + map + R"(", )" + more + R"("robots": [{"name": "a", "start": )" + first_start +
         R"(, "goal": {"x": 30, "y": 5}}, {"name": "b", "start": {"x": 20, "y": 15}, "goal": {"x": 35, "y": 15}}]})";
}

TEST(CommandLine, BadInputIsReportedInOneLineThatNamesThePlace) {
  const test::TemporaryFolder folder;
  folder.write("good.map", free_map(20));
  folder.write("short.map", free_map(12));
  const std::string fine = R"({"x": 5, "y": 5})";
  ASSERT_EQ(test::shell(coppice("plan --quiet '" +
                                folder.write("fine.json", scenario("good.map", fine)).string() + "'"))
                .exit_code,
            0)
      << "without a fault it must be accepted";
  const std::vector<BadInput> cases = {
      {"missing map", scenario("none.map", fine), "none.map"},
      {"truncated map", scenario("short.map", fine), "short.map"},
      {"start in an obstacle", scenario("good.map", R"({"x": 5, "y": 10.5})"), "robots[0].start"},
      {"two on one spot", scenario("good.map", R"({"x": 20, "y": 15})"), "robots["},
      {"unknown field", scenario("good.map", fine, R"("radius": 1, "colour": "red", )"), "colour"},
      {"not a number", scenario("good.map", R"({"x": "NaN", "y": 5})"), "robots[0].start"},
      {"negative radius", scenario("good.map", fine, R"("radius": -1, )"), "radius"},
      {"negative tolerance", scenario("good.map", fine, R"("radius": 1, "goal_tolerance": -1, )"),
       "goal_tolerance"},
      {"forgotten coordinate", scenario("good.map", R"({"x": 5})"), "robots[0].start.y: is missing"},
      {"no comma", scenario("good.map", "\n{\"x\": 5\n\"y\": 5}"),
       "bad.json:3: robots[0].start.x: Missing a comma or '}'"},
      {"comma in a name",
       R"({"map": "good.map", "robots": [{"name": "a,b", "start": {"x": 9, "y": 5}, "goal": {"x": 9, "y": 5}}]})",
       "robots[0].name"},
      {"no JSON", "{\"map\": ", "bad.json"},
      {"empty", "", "bad.json"},
  };
  for (const BadInput& bad : cases) {
    const std::string file = "'" + folder.write("bad.json", bad.scenario).string() + "'";
    for (const char* command : {"run ", "simulate ", "plan "}) {
      const test::Outcome outcome = test::shell(coppice(command + file));
      EXPECT_EQ(outcome.exit_code, 2) << command << bad.name;
      EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1)
          << bad.name << ": " << outcome.output;
      EXPECT_NE(outcome.output.find(bad.named), std::string::npos) << bad.name << ": " << outcome.output;
    }
  }
}

TEST(CommandLine, AnUnreachableGoalIsReportedWithoutAnEndlessSearch) {
  const test::TemporaryFolder folder;
  std::string map = "type octile\nheight 20\nwidth 40\nmap\n";
  for (int row = 0; row < 20; ++row) map += std::string(12, '.') + "@" + std::string(27, '.') + "\n";
  folder.write("good.map", map);
  const std::string file = folder.write("apart.json", scenario("good.map", R"({"x": 5, "y": 5})")).string();
  const std::string report = (folder.path() / "report.json").string();
  const test::Outcome outcome = test::shell(coppice("plan '" + file + "' --report '" + report + "'"));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
  EXPECT_NE(test::contents(report).find("no path"), std::string::npos) << test::contents(report);
}

TEST(CommandLine, EveryProgramPrintsItsVersion) {
  for (const char* name : {"coppice", "tree_broker", "robot_agent", "planner_service"}) {
    const test::Outcome outcome = test::shell("'" + test::program(name) + "' --version");
    EXPECT_EQ(outcome.exit_code, 0) << name;
    EXPECT_EQ(outcome.output, COPPICE_VERSION "\n") << name;
  }
}

// The error must not come after a run of an hour.
TEST(CommandLine, FilesThatCannotBeWrittenAreReportedBeforeTheRun) {
  const test::TemporaryFolder folder;
  const std::string there = folder.path().string();
  for (const std::string command : {"simulate", "run", "plan"}) {
    for (const std::string option : {"--report", "--trajectory", "--picture"}) {
      for (const std::string& file : {there + "/none/x", there, std::string("''")}) {
        const test::Outcome outcome = test::shell(coppice(command + " scenario.json " + option + " " + file));
        EXPECT_EQ(outcome.exit_code, 2) << command << option << file;
        EXPECT_NE(outcome.output.find(option), std::string::npos) << outcome.output;
        EXPECT_EQ(outcome.output.find("scenario.json"), std::string::npos) << outcome.output;
      }
    }
  }
  for (const std::string command :
       {"run scenario.json --record ", "simulate scenario.json --record ", "record "}) {
    const test::Outcome outcome = test::shell(coppice(command + there + "/none/x"));
    EXPECT_EQ(outcome.exit_code, 2) << command;
    EXPECT_NE(outcome.output.find("there is no folder " + there + "/none"), std::string::npos)
        << outcome.output;
  }
  const test::Outcome outcome = test::shell(coppice("plan scenario.json --report " + there + "/none/x"));
  EXPECT_NE(outcome.output.find("there is no folder " + there + "/none"), std::string::npos)
      << outcome.output;
}

int count_of(const std::string& what, const std::string& text) {
  int count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

TEST(CommandLine, APictureThatIsNoSvgIsRefusedAtOnce) {
  for (const std::string command : {"plan", "simulate", "run"}) {
    for (const std::string name : {"x.png", "x.svgz", "x"}) {
      const test::Outcome outcome = test::shell(coppice(command + " none.json --picture " + name));
      EXPECT_EQ(outcome.exit_code, 2) << command;
      EXPECT_NE(outcome.output.find(name + " is not allowed, expected a name that ends in .svg"),
                std::string::npos)
          << outcome.output;
    }
  }
  EXPECT_EQ(
      test::shell(coppice("plan " + rooms() + " --robots 1 --plan-budget 0 --picture /dev/null")).exit_code,
      0);
}

TEST(CommandLine, AnUnusableFolderForTemporaryFilesIsReported) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("file", "").string();
  for (const auto& [place, why] :
       {std::pair(std::string("/nope"), "No such file or directory"), std::pair(file, "Not a directory")}) {
    for (const std::string& command :
         {coppice("run " + rooms()), "'" + test::program("planner_service") + "' --domain 7 " + rooms()}) {
      const test::Outcome outcome = test::shell("TMPDIR='" + place + "' " + command);
      EXPECT_EQ(outcome.exit_code, 2) << command;
      EXPECT_EQ(count_of(place + ": cannot hold temporary files: " + why, outcome.output), 1)
          << outcome.output;
    }
  }
}

TEST(CommandLine, AWarningAboutAMapIsPrintedOnce) {
  const test::TemporaryFolder folder;
  folder.write(
      "site.pgm", "P2\n20 20\n255\n" + [] {
        std::string shades;
        for (int k = 0; k < 400; ++k) shades += "254 ";
        return shades;
      }());
  folder.write("site.yaml", "image: site.pgm\nresolution: 1\norigin: [0, 0, 0]\nfree_thresh: 0.25\n");
  const std::string scenario =
      folder
          .write(
              "fleet.json",
              R"({"map": "site.yaml", "radius": 1, "robots": [{"name": "r1", "start": {"x": 5, "y": 5}, "goal": {"x": 9, "y": 5}}]})")
          .string();
  for (const std::string command : {"plan ", "simulate ", "run "}) {
    const test::Outcome outcome = test::shell(coppice(command + scenario));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_EQ(count_of("site.yaml: free_thresh 0.25 makes shade 205 free", outcome.output), 1)
        << outcome.output;
  }
}

TEST(CommandLine, AnErrorOfEveryProcessOfARunIsReportedOnce) {
  struct Refused {
    std::string environment;
    std::string options;
    std::string named;
  };
  const std::vector<Refused> cases = {
      {"", "--state /proc/nope", "/proc/nope: cannot be made"},
      {"", "--logs /proc/nope", "/proc/nope: cannot be made"},
      {"", "--plan-budget 1e10", "--plan-budget"},
      {"", "--report /tmp/coppice-one --trajectory /tmp/../tmp/coppice-one", "is named for two files"},
      {"", "--report " + rooms(), "is named for two files"},
      {"", "--record /tmp/coppice-one --report /tmp/coppice-one", "is named for two files"},
      {"ROS_DISCOVERY_SERVER=nonsense", "", "\"nonsense\" names no discovery servers"},
      {"", "--discovery host.invalid:7400", "\"host.invalid:7400\" names no discovery servers"},
      {"", "--discovery 127.0.0.1:7400 --security /none", "--security goes without discovery servers"},
      {"ROS_DISCOVERY_SERVER=127.0.0.1:7400", "--security /none",
       "--security goes without discovery servers"},
  };
  for (const Refused& refused : cases) {
    const test::Outcome outcome =
        test::shell(refused.environment + " " + coppice("run " + rooms() + " " + refused.options));
    EXPECT_EQ(outcome.exit_code, 2) << refused.options;
    EXPECT_EQ(count_of(refused.named, outcome.output), 1) << refused.options << ": " << outcome.output;
    EXPECT_EQ(outcome.output.find("ended early"), std::string::npos) << outcome.output;
  }
}

TEST(CommandLine, AFolderOfBlackBoxesThatCannotBeMadeIsRefusedBeforeTheRun) {
  for (const std::string& program : {std::string("robot_agent' --name r1"), "planner_service' " + rooms()}) {
    const test::Outcome outcome =
        test::shell("'" + test::program(program) + " --domain 7 --black-boxes /proc/nope");
    EXPECT_EQ(outcome.exit_code, 2) << program;
    EXPECT_NE(outcome.output.find("/proc/nope: cannot be made"), std::string::npos) << outcome.output;
  }
}

TEST(CommandLine, TheErrorThatEndsAProgramIsLoggedAtEveryLevel) {
  for (const std::string program :
       {"tree_broker' --state /proc/nope", "robot_agent' --name r1 --state /proc/nope",
        "planner_service' /proc/nope", "coppice' discovery --alive /proc/nope --port 23936"}) {
    for (const std::string level : {"off", "info"}) {
      const test::Outcome outcome =
          test::shell("'" + test::program(program) + " --log-json --log-level " + level);
      EXPECT_EQ(outcome.exit_code, 2) << program;
      const auto last = outcome.output.rfind('{');
      ASSERT_NE(last, std::string::npos) << program << outcome.output;
      const std::string line = outcome.output.substr(last);
      EXPECT_NE(line.find(R"("level":"error")"), std::string::npos) << line;
      EXPECT_NE(line.find("/proc/nope"), std::string::npos) << line;
    }
  }
}

TEST(CommandLine, ABenchmarkTakesTheDiscoveryOptionsOfAFleet) {
  const test::Outcome outcome = test::shell(coppice("bench scale --discovery nonsense"));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(outcome.output.starts_with("--discovery: nonsense")) << outcome.output;
}

TEST(CommandLine, TheProcessesOfAFleetRefuseBadUsage) {
  for (const std::string& name :
       {std::string("''"), std::string("'two words'"), std::string("a/b"), std::string(65, 'x')}) {
    EXPECT_EQ(test::shell("'" + test::program("robot_agent") + "' --domain 7 --name " + name).exit_code, 2);
  }
  EXPECT_EQ(test::shell("'" + test::program("tree_broker") + "' --domain x").exit_code, 2);
  EXPECT_EQ(test::shell("'" + test::program("tree_broker") + "' --log-level loud").exit_code, 2);
  EXPECT_EQ(test::shell("'" + test::program("planner_service") + "' --domain 7 none.json").exit_code, 2);
}

}  // namespace
}  // namespace coppice
