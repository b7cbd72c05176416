// Tests of which log lines of a run's processes are passed on.
#include "coppice/run/log_watch.h"

#include <fstream>

#include <gtest/gtest.h>

#include "files/temporary_folder.h"

namespace coppice {
namespace {

class LogWatchTest : public testing::Test {
 protected:
  void log(const std::string& name, const std::string& text) {
    std::ofstream(folder.path() / (name + ".log"), std::ios::app) << text;
  }
  using Lines = std::vector<std::string>;
  TemporaryFolder folder;
  LogWatch watch{folder.path(), {"robot-r1", "tree_broker"}, true};
};

TEST_F(LogWatchTest, WarningsAndErrorsArePassedOnWithTheRobotsName) {
  EXPECT_TRUE(watch.news(1).empty()) << "there is no log yet";
  log("robot-r1",
      "2026-11-26 20:55:22.123 info robot_agent r1: on domain 7\n"
      "2026-11-26 20:55:23.123 warning robot_agent r1: missed: 3\n2026-11-26 20:55:23.123 err");
  log("tree_broker", "something that no logger wrote: a warning\n");
  EXPECT_EQ(watch.news(2), Lines{"r1: warning: missed: 3"});
  log("robot-r1", "or robot_agent r1: out of luck\n");
  EXPECT_EQ(watch.news(3), Lines{"r1: error: out of luck"});
  EXPECT_TRUE(watch.news(4).empty());
}

TEST_F(LogWatchTest, LinesOfJsonArePassedOnUnchanged) {
  const std::string warning = R"({"time":"t","level":"warning","name":"robot_agent r1","message":"m"})";
  log("robot-r1", R"({"time":"t","level":"info","name":"robot_agent r1","message":"level warning"})"
                  "\n" +
                      warning + "\n");
  EXPECT_EQ(watch.news(1), Lines{"r1: " + warning});
}

TEST_F(LogWatchTest, TheFirstOfManyLinesArePassedOnAndTheRestIsCounted) {
  for (int k = 0; k < 100; ++k) log("robot-r1", "2026-11-26 20:55:23.123 warning robot_agent r1: again\n");
  EXPECT_EQ(watch.news(1).size(), 3u);
  log("tree_broker", "2026-11-26 20:55:23.123 warning tree_broker: another\n");
  EXPECT_EQ(watch.news(2), Lines{"tree_broker: warning: another"});
  EXPECT_EQ(watch.news(11.5), Lines{"97 more warnings are in " + folder.path().string()});
  EXPECT_TRUE(watch.news(30).empty());
}

TEST_F(LogWatchTest, AReplacedLogIsReadFromItsBeginning) {
  std::string old(500, 'x');
  old += '\n';
  log("robot-r1", old);
  EXPECT_TRUE(watch.news(1).empty());
  std::filesystem::remove(folder.path() / "robot-r1.log");
  log("robot-r1", "2026-11-26 20:55:23.123 warning robot_agent r1: new\n");
  EXPECT_EQ(watch.news(2), Lines{"r1: warning: new"});
}

TEST_F(LogWatchTest, TheLastNewsHoldAllRemainingLinesAndTheNumberOfTheRest) {
  std::string noise(200'000, 'x');
  noise += '\n';
  for (int k = 0; k < 5; ++k) log("robot-r1", "2026-11-26 20:55:23.123 warning robot_agent r1: again\n");
  log("tree_broker", noise + "2026-11-26 20:55:23.123 warning tree_broker: late\n");
  const Lines again(3, "r1: warning: again");
  EXPECT_EQ(watch.news(1), again);
  EXPECT_EQ(watch.last_news(2),
            (Lines{"tree_broker: warning: late", "2 more warnings are in " + folder.path().string()}));
}

}  // namespace
}  // namespace coppice
