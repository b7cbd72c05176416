// Tests of a process that is paused for longer than Fast DDS usually waits (20 s). After it resumes, all
// processes find each other again, the run ends, and its record is complete.
//
// CTest: PARALLEL

#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>

#include "files/report_file.h"
#include "tests/domains.h"
#include "tests/processes.h"
#include "tests/run_check.h"
#include "tests/run_expectations.h"
#include "tests/support.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

class PausedProcess : public testing::TestWithParam<const char*> {};

TEST_P(PausedProcess, APausedProcessReturnsAndTheRecordIsComplete) {
  if (!test::wants_long_tests()) GTEST_SKIP() << test::why_not_long;
  const test::TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder.path() / name).string(); };
  test::Background run({test::program("coppice"), "run", (test::scenarios() / "rooms-8.json").string(),
                        "--domain", test::domain_name(), "--discovery", "multicast", "--time-scale", "0.3",
                        "--report", file("report.json"), "--trajectory", file("t.csv")},
                       file("log"));
  ASSERT_TRUE(test::within(
      20s, [&] { return test::contents(file("log")).find("paths found 8/8") != std::string::npos; }));
  auto processes = test::children_of(run.pid());
  std::erase_if(processes, [&](const test::ProcessInfo& child) { return child.name != GetParam(); });
  ASSERT_FALSE(processes.empty());
  std::this_thread::sleep_for(5s);
  kill(processes.front().pid, SIGSTOP);
  std::this_thread::sleep_for(26s);
  kill(processes.front().pid, SIGCONT);

  EXPECT_EQ(run.wait(), 0) << test::contents(file("log"));
  const proto::Report report = read_report(file("report.json"));
  EXPECT_EQ(report.outcome(), "arrived");
  test::expect_good_motion(report, file("t.csv"), 5, test::PlainMap(test::scenarios() / "rooms-8.map"));
}

INSTANTIATE_TEST_SUITE_P(Roles, PausedProcess, testing::Values("planner_service", "robot_agent"));

}  // namespace
}  // namespace coppice
