// Tests of mistakes at the command line. Each is reported in one line that says what to do, with exit code 2,
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

std::string rooms() {
  return (test::scenarios() / "rooms-8.json").string();
}

/// What the command prints on standard error.
test::Outcome errors_of(const std::string& program, const std::string& arguments) {
  return test::shell("{ '" + test::program(program) + "' " + arguments + " 2>&1 >/dev/null; }");
}

void expect_one_line(const std::string& program, const std::string& arguments,
                     const std::vector<std::string>& named) {
  const test::Outcome outcome = errors_of(program, arguments);
  EXPECT_EQ(outcome.exit_code, 2) << program << " " << arguments;
  EXPECT_EQ(std::ranges::count(outcome.output, '\n'), 1) << arguments << ": " << outcome.output;
  for (const std::string& text : named)
    EXPECT_NE(outcome.output.find(text), std::string::npos) << arguments << ": " << outcome.output << text;
}

TEST(Mistakes, AnUnknownOptionNamesTheNearest) {
  expect_one_line("coppice", "run " + rooms() + " --robtos 3",
                  {"--robtos: unknown option, did you mean --robots?", "(coppice run --help)"});
  expect_one_line("coppice", "run --robtos=3 " + rooms(), {"--robtos=3: unknown option", "--robots"});
  expect_one_line("coppice", "run --dom 3 " + rooms(), {"did you mean --domain?"});
  expect_one_line("coppice", "simulate -report x " + rooms(), {"did you mean --report?"});
  expect_one_line("coppice", "run --zzzzzz " + rooms(), {"--zzzzzz: unknown option (coppice run --help)"});
  expect_one_line("coppice", "--domain 3 run " + rooms(), {"--domain: goes after the command"});
  expect_one_line("tree_broker", "--domian 3", {"did you mean --domain?", "(tree_broker --help)"});
  expect_one_line("robot_agent", "--nmae r1", {"did you mean --name?", "(robot_agent --help)"});
  expect_one_line("planner_service", rooms() + " --timeuot 3", {"did you mean --timeout?"});
}

TEST(Mistakes, AnUnknownCommandNamesTheNearest) {
  expect_one_line("coppice", "simulat " + rooms(), {"simulat: unknown subcommand, did you mean simulate?"});
  expect_one_line("coppice", "rnu", {"did you mean run?"});
  expect_one_line("coppice", "fly", {"fly: unknown subcommand, expected one of run, serve,"});
  expect_one_line("coppice", "", {"expected a subcommand: run, serve,"});
  expect_one_line("coppice", "help fyl", {"there is no fyl, expected one of report, run,"});
  expect_one_line("coppice", "help simualte", {"did you mean simulate?"});
}

TEST(Mistakes, RoundsAndPlansGoWithOneCoordinationOnly) {
  for (const char* rounds : {"on", "off"}) {
    for (const char* coordination : {"", " --coordination reservations"})
      expect_one_line("coppice", "simulate " + rooms() + coordination + " --rounds " + rounds,
                      {std::string("--rounds ") + rounds + ": goes with --coordination rvo only"});
  }
  expect_one_line("coppice", "run " + rooms() + " --rounds off", {"--rounds off: goes with"});
  expect_one_line("planner_service", rooms() + " --domain 99 --rounds off", {"--rounds off: goes with"});
  expect_one_line("coppice", "simulate " + rooms() + " --plan p.txt --coordination rvo",
                  {"--plan: goes with --coordination reservations only"});
}

TEST(Mistakes, AMissingOrAdditionalArgumentIsNamed) {
  expect_one_line("coppice", "run", {"scenario is missing, expected a scenario (.json)"});
  expect_one_line("planner_service", "--domain 3", {"scenario is missing"});
  expect_one_line("coppice", "map room", {"output is missing"});
  expect_one_line("coppice", "run " + rooms() + " other.json", {"other.json: one argument too many"});
  expect_one_line("coppice", "run " + rooms() + " domain 3", {"did you mean --domain?"});
  expect_one_line("tree_broker", "rooms.json", {"rooms.json: one argument too many"});
  expect_one_line("coppice", "plan -- " + rooms() + " --quiet", {"--quiet: one argument too many"});
}

TEST(Mistakes, AnOptionWithoutItsValueIsNamed) {
  expect_one_line("coppice", "run " + rooms() + " --domain", {"--domain: expected a value", "0 to 232"});
  expect_one_line("coppice", "run --domain --robots 3 " + rooms(), {"--domain: expected a value"});
  expect_one_line("coppice", "plan " + rooms() + " --report --picture x.svg",
                  {"--report: expected a value, FILE"});
  EXPECT_FALSE(std::filesystem::exists("--picture"));
  expect_one_line("coppice", "plan " + rooms() + " --seed 1 --seed 2",
                  {"--seed: given 2 times, expected once"});
  expect_one_line("coppice",
                  "plan " + rooms() + " --seed=", {"--seed: expected a value, N [0 to 4294967295"});
  expect_one_line("coppice", "plan " + rooms() + " --quiet=maybe", {"--quiet: takes no value"});
}

TEST(Mistakes, AValueOutOfRangeIsReportedWithTheRange) {
  expect_one_line("coppice", "run " + rooms() + " --domain 233", {"--domain", "233", "0 to 232"});
  expect_one_line("coppice", "monitor --domain -1", {"--domain", "0 to 232"});
  expect_one_line("coppice", "plan " + rooms() + " --seed -3", {"--seed", "-3", "0 to 4294967295"});
  expect_one_line("coppice", "plan " + rooms() + " --robots 2.5", {"--robots", "2.5", "1 to 100000"});
  expect_one_line("coppice", "plan " + rooms() + " --radius 0", {"--radius", "above 0"});
  expect_one_line("coppice", "plan " + rooms() + " --planner best", {"--planner", "best", "rrt-star"});
  expect_one_line("coppice", "run " + rooms() + " --coordination orca", {"--coordination", "orca", "rvo"});
  expect_one_line("coppice", "monitor --port 65536", {"--port", "0 to 65535"});
  expect_one_line("coppice", "run --ros --drive ros --tracking-tolerance nan " + rooms(),
                  {"--tracking-tolerance", "nan", "0.001 to 1000"});
  expect_one_line("coppice", "run --ros --drive ros --pose gps " + rooms(), {"--pose", "gps", "amcl_pose"});
  expect_one_line("coppice", "run --ros --ros-namespace 'a b' " + rooms(),
                  {"--ros-namespace", "a b", "no name in ROS"});
  expect_one_line("coppice", "run --stamped " + rooms(), {"--stamped", "--ros"});
  expect_one_line("coppice", "simulate --margin -1 " + rooms(), {"--margin", "-1"});
  expect_one_line("coppice", "simulate --slip 0.6 " + rooms(), {"--slip", "0.6", "0 to 0.5"});
  expect_one_line("coppice", "simulate --odometry-noise nan " + rooms(), {"--odometry-noise", "nan"});
  expect_one_line("robot_agent", "--ros --drive ros --odom-timeout nan", {"--odom-timeout", "0.05 to 60"});
  expect_one_line("tree_broker", "--datagram 9", {"--datagram", "1344 to 65500"});
  expect_one_line("tree_broker", "--seed -1", {"--seed", "-1", "0 to 18446744073709551615"});
  expect_one_line("tree_broker", "--seed 99999999999999999999", {"--seed", "0 to 18446744073709551615"});
  expect_one_line("planner_service", "--domain 0x7 a.json", {"--domain", "0x7", "0 to 232"});
}

TEST(Mistakes, ANewlineInAnArgumentGivesNoSecondLine) {
  expect_one_line("coppice", "run 'a.json\nb' --x 'y\nz'", {"--x: unknown option"});
}

/// Files of all kinds, each in the place of another kind.
class WrongKindOfFile : public testing::Test {
  test::TemporaryFolder folder_;

 protected:
  std::string file(const std::string& name, const std::string& content) const {
    return "'" + folder_.write(name, content).string() + "'";
  }
  std::string folder() const { return "'" + folder_.path().string() + "'"; }
  const std::string map_ = file("a.map", "type octile\nheight 2\nwidth 2\nmap\n..\n..\n");
  const std::string ros_map_ = file("a.yaml", "image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n");
  const std::string picture_ = file("a.png", "\x89PNG\r\n\x1a\n");
  const std::string drawing_ = file("a.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\"/>");
  const std::string recording_ = file("a.mcap", "\x89MCAP0\r\n");
  const std::string trajectory_ = file("a.csv", "time,robot,x,y,vx,vy,yaw,omega\n0,r1,1,1,0,0,0,0\n");
  const std::string report_ =
      file("report.json", "{\n \"outcome\": \"arrived\",\n \"map\": \"a.map\", \"robots\": []}");
  const std::string empty_ = file("empty.json", "");
};

TEST_F(WrongKindOfFile, AFileInPlaceOfAScenarioIsNamed) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {map_, "is a Moving AI map, expected a scenario (.json or .scen): coppice map FILE OUT.json"},
      {ros_map_, "is a ROS map, expected a scenario"},
      {picture_, "is a picture, expected a scenario"},
      {drawing_, "is a picture, expected a scenario"},
      {recording_, "is a recording, expected a scenario (.json or .scen): coppice monitor FILE"},
      {trajectory_, "is a trajectory of a run, expected a scenario"},
      {report_, "is a report of a run, expected a scenario"},
      {empty_, "is empty, expected a scenario"},
      {folder(), "is a folder, expected a file"},
      {"/nowhere/a.json", "/nowhere/a.json: cannot be read: No such file"},
  };
  for (const auto& [name, said] : files) {
    for (const char* command : {"run ", "simulate ", "plan "})
      expect_one_line("coppice", command + name, {said});
    expect_one_line("planner_service", "--domain 99 " + name, {said});
  }
}

TEST_F(WrongKindOfFile, AFileInPlaceOfAMapIsNamed) {
  const std::string out = " '" + folder().substr(1, folder().size() - 2) + "/out.json'";
  expect_one_line("coppice", "map " + rooms() + out, {"is a scenario, expected a map (.map or .yaml)"});
  expect_one_line("coppice", "map " + picture_ + out, {"is a picture, expected a map"});
  expect_one_line("coppice", "map " + recording_ + out, {"is a recording, expected a map"});
  expect_one_line("coppice", "bench peers --maps " + rooms(), {"is a scenario, expected a map"});
  const std::string names_a_recording = file("b.json", R"({"map": "a.mcap", "robots": [{"name": "r1"}]})");
  expect_one_line("coppice", "plan " + names_a_recording,
                  {"b.json: map: ", "a.mcap: is a recording, expected a map"});
}

TEST_F(WrongKindOfFile, AFileInPlaceOfARecordingIsNamed) {
  for (const char* command : {"monitor ", "info ", "replay "}) {
    expect_one_line("coppice", command + rooms(), {"is a scenario, expected a recording (MCAP)"});
    expect_one_line("coppice", command + map_, {"is a Moving AI map, expected a recording (MCAP)"});
    expect_one_line("coppice", command + empty_, {"is empty, expected a recording (MCAP)"});
    expect_one_line("coppice", command + folder(), {"is a folder, expected a file"});
  }
  expect_one_line("coppice", "picture " + rooms() + " out.svg",
                  {"is a scenario, expected a recording (MCAP)"});
}

TEST_F(WrongKindOfFile, AMissingMapIsReportedWithItsScenario) {
  const std::string scenario = file("c.json", R"({"map": "none.map", "robots": [{"name": "r1"}]})");
  expect_one_line("coppice", "run " + scenario,
                  {"c.json: map: there is no ", "none.map (--map FILE names a map that lies elsewhere)"});
}

TEST_F(WrongKindOfFile, AWrongFieldIsReportedWithItsLineAndTheAllowedValues) {
  const std::string start =
      file("d.json", "{\"map\": \"a.map\", \"robots\": [\n{\"name\": \"r1\", \"start\": [20, 20]}]}");
  expect_one_line(
      "coppice", "run " + start,
      {"d.json:2: robots[0].start: expected {\"x\": ..., \"y\": ..., \"yaw\": ...}, found a list"});
  const std::string field = file("e.json", "{\"map\": \"a.map\",\n\n\"robtos\": []}");
  expect_one_line(
      "coppice", "run " + field,
      {"e.json:3: \"robtos\" is not a field (did you mean robots?), expected one of map, radius"});
}

TEST(Mistakes, AnOutputThatCannotBeMadeIsReportedAtOnce) {
  for (const std::string option : {"--record", "--report", "--trajectory", "--picture"}) {
    for (const std::string place : {"/proc/x", "/sys/x", "/nowhere/x", "/dev/null/x"}) {
      for (const char* command : {"run ", "simulate "})
        expect_one_line("coppice", command + rooms() + " " + option + " " + place, {option, place});
    }
  }
  const std::string long_name(300, 'x');
  expect_one_line("coppice", "plan " + rooms() + " --report /tmp/" + long_name, {"File name too long"});
  expect_one_line("coppice", "record /proc/x.mcap", {"/proc/x.mcap cannot be written"});
  expect_one_line("coppice", "map room /proc/x.json", {"/proc/x.json cannot be written"});
  expect_one_line("coppice", "bench peers --quick --output /proc",
                  {"--output", "nothing can be written to /proc"});
  for (const std::string option : {"--state", "--logs"})
    expect_one_line("coppice", "run " + rooms() + " " + option + " /proc",
                    {"nothing can be written to /proc"});
}

TEST(Mistakes, AnOutputIsWrittenToTheTargetOfItsLink) {
  const test::TemporaryFolder folder;
  const auto link = folder.path() / "link.json";
  std::filesystem::create_symlink("/proc/x.json", link);
  expect_one_line("coppice", "plan none.json --report '" + link.string() + "'",
                  {"link.json cannot be written"});
}

TEST(Mistakes, CheckingWhetherAFileCanBeMadeLeavesNothing) {
  const test::TemporaryFolder folder;
  const std::string report = (folder.path() / "report.json").string();
  EXPECT_EQ(errors_of("coppice", "plan none.json --report '" + report + "'").exit_code, 2);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Help, BothWaysToAskForHelpPrintTheSame) {
  for (const std::string command : {"run", "monitor", "map", "bench"}) {
    const test::Outcome asked = test::shell("'" + test::program("coppice") + "' help " + command);
    EXPECT_EQ(asked.exit_code, 0);
    EXPECT_EQ(asked.output, test::shell("'" + test::program("coppice") + "' " + command + " --help").output);
    EXPECT_NE(asked.output.find("Usage: coppice " + command), std::string::npos) << asked.output;
  }
  EXPECT_EQ(test::shell("'" + test::program("coppice") + "' help").output,
            test::shell("'" + test::program("coppice") + "' --help").output);
  const test::Outcome report = test::shell("'" + test::program("coppice") + "' help report");
  EXPECT_NE(report.output.find("least_separation"), std::string::npos) << report.output;
}

}  // namespace
}  // namespace coppice
