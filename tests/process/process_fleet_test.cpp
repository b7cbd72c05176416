// Tests that no child outlives its parent, however the parent ends.
//
// CTest: PARALLEL

#include "coppice/run/process_fleet.h"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;
using Output = ProcessFleet::Output;

std::vector<std::string> script(const std::string& text) {
  return {"/bin/sh", "-c", text};
}

/// A child that writes its process id to a file and stays.
std::vector<std::string> stays(const std::filesystem::path& tell) {
  return script("echo $$ > '" + tell.string() + ".new'; mv '" + tell.string() + ".new' '" + tell.string() +
                "'; exec sleep 100");
}

pid_t told(const std::filesystem::path& file) {
  EXPECT_TRUE(test::within(5s, [&] { return std::filesystem::exists(file); }));
  const std::string text = test::contents(file);
  return text.empty() ? 0 : std::stoi(text);
}

ProcessFleet::Ended next_end(ProcessFleet& fleet) {
  std::optional<ProcessFleet::Ended> ended;
  EXPECT_TRUE(test::within(5s, [&] { return (ended = fleet.reap()).has_value(); }));
  return ended.value_or(ProcessFleet::Ended{});
}

TEST(ProcessFleet, TheFleetReportsEachEndWithExitCodeAndLastWords) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  EXPECT_FALSE(fleet.reap());
  fleet.start("r1", script("echo out; echo no map >&2; exit 3"), Output::log);
  const auto exited = next_end(fleet);
  EXPECT_EQ(exited.name, "r1");
  EXPECT_EQ(exited.exit_code, 3);
  EXPECT_EQ(exited.log_end, "out\nno map\n");
  fleet.start("r2", script("kill -SEGV $$"), Output::log);
  EXPECT_EQ(next_end(fleet).exit_code, 128 + SIGSEGV);
  EXPECT_FALSE(fleet.reap());
}

// The signal takes effect as soon as it can, however early it comes.
TEST(ProcessFleet, AProcessThatIsStoppedWhileItStartsEnds) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  for (const int milliseconds : {0, 1, 2, 5, 10, 20, 40}) {
    fleet.start("broker", {test::program("tree_broker"), "--domain", test::domain_name()}, Output::log);
    std::this_thread::sleep_for(milliseconds * 1ms);
    fleet.terminate("broker");
    EXPECT_EQ(next_end(fleet).exit_code, 0) << milliseconds;
  }
}

TEST(ProcessFleet, ALogGoesOnIfItsProcessIsRestarted) {
  const test::TemporaryFolder folder;
  folder.write("r1.log", "of another run\n");
  ProcessFleet fleet(folder.path());
  fleet.start("r1", script("echo here"), Output::log);
  EXPECT_EQ(next_end(fleet).log_end, "here\n");
  fleet.start_again("r1");
  EXPECT_EQ(next_end(fleet).log_end, "here\nhere\n");
}

TEST(ProcessFleet, TheLastWordsAreTheEndOfALongLog) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  fleet.start("r1", script("seq 1000; echo end"), Output::log);
  const std::string last = next_end(fleet).log_end;
  EXPECT_EQ(last.size(), 300u);
  EXPECT_TRUE(last.ends_with("\n1000\nend\n")) << last;
}

TEST(ProcessFleet, AProcessThatCannotBeStartedIsAnError) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  EXPECT_THROW(fleet.start("r1", {"/nowhere/robot_agent"}, Output::log), std::runtime_error);
  EXPECT_FALSE(fleet.reap());
}

TEST(ProcessFleet, TheFleetEndsItsChildrenWithItself) {
  const test::TemporaryFolder folder;
  pid_t child = 0;
  {
    ProcessFleet fleet(folder.path());
    fleet.start("r1", stays(folder.path() / "pid"), Output::log);
    child = told(folder.path() / "pid");
    EXPECT_FALSE(test::has_ended(child));
  }
  EXPECT_TRUE(test::has_ended(child));
}

TEST(ProcessFleet, TheFleetAsksFirstAndKillsAfterTheGracePeriod) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  const std::string ready = "; touch '" + folder.path().string() + "/ready-'$0; while :; do sleep 0.05; done";
  fleet.start("polite", {"/bin/sh", "-c", "trap 'echo asked; exit 0' TERM" + ready, "polite"}, Output::log);
  fleet.start("deaf", {"/bin/sh", "-c", "trap '' TERM" + ready, "deaf"}, Output::log);
  for (const char* name : {"ready-polite", "ready-deaf"}) {
    ASSERT_TRUE(test::within(5s, [&] { return std::filesystem::exists(folder.path() / name); }));
  }
  const auto children = test::children_of(getpid());
  const auto begin = std::chrono::steady_clock::now();
  const auto ended = fleet.terminate_all(500ms);
  const auto took = std::chrono::steady_clock::now() - begin;
  ASSERT_EQ(ended.size(), 2u);
  EXPECT_EQ(ended[0].name, "polite");
  EXPECT_EQ(ended[0].exit_code, 0);
  EXPECT_EQ(ended[1].name, "deaf");
  EXPECT_EQ(ended[1].exit_code, 128 + SIGKILL);
  EXPECT_GE(took, 500ms);
  EXPECT_LT(took, 3s);
  EXPECT_EQ(test::contents(folder.path() / "polite.log"), "asked\n");
  for (const auto& child : children) {
    EXPECT_TRUE(child.name != "sh" || test::has_ended(child.pid));
  }
}

TEST(ProcessFleet, AProcessMayStayUntilTheOthersHaveEnded) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  const pid_t leaves = fleet.start("r1", stays(folder.path() / "1"), Output::log);
  const pid_t remains = fleet.start("recorder", stays(folder.path() / "2"), Output::log);
  told(folder.path() / "1");
  told(folder.path() / "2");
  fleet.terminate_all(5s, "recorder");
  EXPECT_TRUE(test::has_ended(leaves));
  EXPECT_FALSE(test::has_ended(remains));
  fleet.terminate_all(5s);
  EXPECT_TRUE(test::has_ended(remains));
}

/// A parent with two children ends by `signal`. Checks that its children end, too.
void expect_nothing_outlives(int signal) {
  const test::TemporaryFolder folder;
  const pid_t parent = fork();
  if (parent == 0) {
    std::signal(SIGHUP, SIG_DFL);  // nohup ignores it
    ProcessFleet fleet(folder.path());
    fleet.start("r1", stays(folder.path() / "1"), Output::log);
    fleet.start("r2", stays(folder.path() / "2"), Output::log);
    while (true) pause();
  }
  told(folder.path() / "1");
  told(folder.path() / "2");
  const auto children = test::children_of(parent);
  EXPECT_EQ(children.size(), 2u);
  kill(parent, signal);
  waitpid(parent, nullptr, 0);
  for (const auto& child : children) {
    EXPECT_TRUE(test::within(3s, [&] { return test::has_ended(child.pid); })) << child.name;
  }
}

TEST(ProcessFleet, NoChildOutlivesAKilledParent) {
  expect_nothing_outlives(SIGKILL);
}
TEST(ProcessFleet, NoChildOutlivesAParentThatHangsUp) {
  expect_nothing_outlives(SIGHUP);
}

TEST(ProcessFleet, AChildMayBeNicerThanItsParent) {
  const test::TemporaryFolder folder;
  ProcessFleet fleet(folder.path());
  fleet.start("nice", script("nice"), Output::log, 3);
  EXPECT_EQ(next_end(fleet).log_end, std::to_string(getpriority(PRIO_PROCESS, 0) + 3) + "\n");
}

}  // namespace
}  // namespace coppice
