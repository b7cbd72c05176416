// Tests that fleets on this machine are found without being named. No other fleet may run here at the same
// time.
//
// CTest: RUN_SERIAL

#include <memory>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

struct FindingFleets : testing::Test {
  std::filesystem::path log(const std::string& name) const { return folder.path() / (name + ".log"); }
  void start(const std::string& name, std::vector<std::string> command) {
    command[0] = test::program(command[0]);
    processes.push_back(std::make_unique<test::Background>(command, log(name)));
  }
  /// Starts a long run and returns its domain.
  std::string start_run(const std::string& name) {
    start(name, {"coppice", "run", (test::scenarios() / "blank-10.json").string(), "--robots", "2",
                 "--lifelong", "1000"});
    const std::regex line(R"(fleet on domain (\d+); watch it with: coppice monitor --domain (\d+)\n)");
    std::smatch told;
    std::string text;
    test::within(20s, [&] {
      text = test::contents(log(name));
      return std::regex_search(text, told, line) && text.find("paths found 2/2") != std::string::npos;
    });
    EXPECT_EQ(told[1], told[2]) << text;
    return told[1];
  }
  static test::Outcome top(const std::string& options = "") {
    return test::shell("'" + test::program("coppice") + "' top --once " + options);
  }

  test::TemporaryFolder folder;
  std::vector<std::unique_ptr<test::Background>> processes{};
};

TEST_F(FindingFleets, ASingleFleetIsTakenAndOfTwoTheUserChooses) {
  EXPECT_NE(top().output.find("no fleet is alive on this machine: waits on domain 0 (--domain)"),
            std::string::npos);
  const std::string domain = start_run("first");
  const test::Outcome found = top();
  EXPECT_EQ(found.exit_code, 0) << found.output;
  EXPECT_NE(found.output.find("takes the fleet that is alive on this machine, domain " + domain +
                              ": 2 robot agents, 2 other roles"),
            std::string::npos)
      << found.output;
  const std::string other = start_run("second");
  EXPECT_NE(other, domain);
  for (const std::string& command :
       {std::string("top --once"), std::string("monitor --port 0"), "record " + log("none").string()}) {
    const test::Outcome choice = test::shell("'" + test::program("coppice") + "' " + command);
    EXPECT_EQ(choice.exit_code, 2) << choice.output;
    const std::string words = "coppice " + command;
    EXPECT_NE(choice.output.find("2 fleets are alive on this machine, choose one:"), std::string::npos);
    EXPECT_NE(choice.output.find(words + " --domain " + domain), std::string::npos) << choice.output;
    EXPECT_NE(choice.output.find(words + " --domain " + other), std::string::npos) << choice.output;
  }
  EXPECT_FALSE(std::filesystem::exists(log("none"))) << "nothing was recorded";
  EXPECT_EQ(top("--domain " + other).exit_code, 0) << "the chosen fleet is shown";
}

TEST_F(FindingFleets, AFleetStartedByHandIsFoundUntilItEnds) {
  start("agent", {"robot_agent", "--name", "r1", "--domain", "57", "--discovery", "static"});
  start("onlooker", {"coppice", "monitor", "--domain", "58", "--port", "0"});
  ASSERT_TRUE(
      test::within(20s, [&] { return test::contents(log("onlooker")).find("http") != std::string::npos; }));
  ASSERT_TRUE(
      test::within(20s, [&] { return top().output.find("domain 57: 1 robot agent") != std::string::npos; }));
  EXPECT_EQ(top().exit_code, 0) << "it is heard because its discovery settings are used";
  processes.clear();
  EXPECT_NE(top().output.find("no fleet is alive"), std::string::npos);
}

}  // namespace
}  // namespace coppice
